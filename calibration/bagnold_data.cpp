#include "calibration/bagnold_data.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "calibration/power_profile.h"

namespace grainlaw::calibration {
namespace {

using dem::LocalRow;

BagnoldData gather(const std::vector<LocalRow>& rows,
                   const std::vector<std::size_t>& chosen,
                   const dem::ChuteConditions& conditions) {
  BagnoldData data;
  double fraction = 0.0;
  for (const std::size_t k : chosen) {
    data.mass_above.push_back(rows[k].mass_above);
    data.velocity.push_back(rows[k].velocity.value);
    data.shear_stress.push_back(rows[k].shear_stress.value);
    data.shear_rate.push_back(rows[k].shear_rate.value);
    fraction += rows[k].volume_fraction.value / static_cast<double>(chosen.size());
  }
  data.density = conditions.grain_density * fraction;
  data.weight_down = conditions.gravity * std::sin(conditions.inclination);
  data.mass = conditions.mass_per_area;
  return data;
}

BagnoldErrors gather_errors(const std::vector<LocalRow>& rows,
                            const std::vector<std::size_t>& chosen) {
  return {.velocity = weight_errors(rows, chosen, &LocalRow::velocity),
          .shear_stress = weight_errors(rows, chosen, &LocalRow::shear_stress),
          .shear_rate = weight_errors(rows, chosen, &LocalRow::shear_rate)};
}

/// b = 0 and the power profile through the velocities: its slope is (2/3) sqrt(c / a) / rho^1.5.
std::array<double, 3> start_values(const BagnoldInput& input, const std::string& run) {
  const BagnoldData& data = input.data;
  const PowerProfile profile =
      fit_power_profile(data.mass_above, data.velocity, input.errors.velocity);
  if (!(profile.slope > 0.0)) {
    throw FitError("run '" + run +
                   "': the velocity does not rise towards the surface, there is no "
                   "shear flow to fit");
  }
  const double a = data.weight_down * std::pow(2.0 / (3.0 * data.density * profile.slope), 2);
  return {a, 0.0, std::max(input.mass_below_base, data.mass - profile.flowing_mass)};
}

/// The lowest of the rows at the top that shear slower than this share of the fastest row, or no
/// faster than chance; rows.size() where the top row shears.
std::size_t first_slow_row(const dem::LocalData& run,
                           const std::vector<std::size_t>& rows,
                           double share) {
  double fastest = 0.0;
  for (const std::size_t k : rows) fastest = std::max(fastest, run.rows[k].shear_rate.value);
  std::size_t first = rows.size();
  while (first > 0) {
    const dem::Estimate& rate = run.rows[rows[first - 1]].shear_rate;
    if (rate.value > std::max(share * fastest, 3.0 * rate.error)) break;
    --first;
  }
  return first;
}

}  // namespace

BagnoldInput prepare(const dem::LocalData& run, const Observations& observations) {
  BagnoldInput input;
  input.data = gather(run.rows, observations.rows, run.conditions);
  input.errors = gather_errors(run.rows, observations.rows);
  for (const std::vector<LocalRow>& rows : blocks_for_fit(run)) {
    input.blocks.push_back(gather(rows, observations.rows, run.conditions));
  }
  input.mass_below_base =
      std::max(0.0,
               run.conditions.mass_per_area -
                   MassColumn(run.rows, run.conditions.grain_density).mass_above(0.0));
  input.start = start_values(input, run.name);
  return input;
}

std::optional<Plug> find_plug(const dem::LocalData& run, const Observations& observations) {
  constexpr double thinnest = 3.0;  // [d]: fewer rows can be at rest by chance
  constexpr double creep = 0.05;    // of the fastest row: below a plug's edge gd falls gradually
  const std::vector<std::size_t>& rows = observations.rows;
  const std::size_t first = first_slow_row(run, rows, creep);
  if (first == 0 || first == rows.size()) return std::nullopt;
  const LocalRow& below = run.rows[rows[first - 1]];
  const LocalRow& lowest = run.rows[rows[first]];
  Plug plug;
  plug.height = 0.5 * (below.z + lowest.z) / run.conditions.grain_diameter;
  plug.thickness = run.rows[rows.back()].z / run.conditions.grain_diameter - plug.height;
  if (plug.thickness < thinnest) return std::nullopt;
  const double weight_down = run.conditions.gravity * std::sin(run.conditions.inclination);
  const double mass = 0.5 * (below.mass_above + lowest.mass_above);
  // The plug ends anywhere between the two rows, a uniform distribution, and half or twice the
  // creep could be taken for rest.
  const double half_row = 0.5 * (below.mass_above - lowest.mass_above) / std::sqrt(3.0);
  const auto mass_above = [&](double share) {
    const std::size_t k = first_slow_row(run, rows, share);
    return run.rows[rows[std::min(k, rows.size() - 1)]].mass_above;
  };
  const double choice = 0.5 * (mass_above(2.0 * creep) - mass_above(0.5 * creep));
  plug.yield_stress_from_weight = {weight_down * mass, weight_down * std::hypot(half_row, choice)};
  return plug;
}

void leave_out_plug(const dem::LocalData& run, const Plug& plug, Observations& observations) {
  const double bottom = plug.height * run.conditions.grain_diameter;
  const std::size_t before = observations.rows.size();
  std::erase_if(observations.rows, [&](std::size_t k) { return run.rows[k].z > bottom; });
  std::ostringstream text;
  text
      << before - observations.rows.size() << " rows above z = " << bottom
      << ": they move as a plug, their shear rate is below 5 % of the largest or 3 standard errors";
  observations.left_out.push_back(text.str());
}

}  // namespace grainlaw::calibration
