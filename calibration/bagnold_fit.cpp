#include "calibration/bagnold_fit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "calibration/differentiate.h"
#include "calibration/least_squares.h"
#include "calibration/observations.h"
#include "calibration/power_profile.h"
#include "continuum/bagnold_profile.h"
#include "continuum/rheology.h"

namespace grainlaw::calibration {
namespace {

using dem::LocalRow;

/// The used rows of a run, or of one block of it, as the law sees them.
struct BagnoldData {
  std::vector<double> mass_above;
  std::vector<double> velocity;
  std::vector<double> shear_stress;
  std::vector<double> shear_rate;
  double density = 0.0;      ///< rho_p phi of the bulk
  double weight_down = 0.0;  ///< g sin(theta)
  double mass = 0.0;         ///< M0
};

/// Standard errors that weigh the residuals.
struct BagnoldErrors {
  std::vector<double> velocity;
  std::vector<double> shear_stress;
  std::vector<double> shear_rate;
};

/// Residuals of the velocities against Brewster eq. 9, depth measured by the mass above, and of the
/// shear rates against the inverse law at the measured stress. Unknowns: a, b and, unless it is
/// fixed, the mass below the no-slip height.
struct BagnoldModel {
  BagnoldData data;
  BagnoldErrors errors;
  std::optional<double> fixed_mass_below;

  template <class Scalar, std::size_t N>
  void operator()(const std::array<Scalar, N>& x, std::span<Scalar> r) const {
    const Scalar tau_c(0.0);  // cohesionless
    const double c = data.density * data.weight_down;
    const Scalar mass_below = fixed_mass_below ? Scalar(*fixed_mass_below) : x[N - 1];
    const Scalar base_depth = (data.mass - mass_below) / data.density;
    const std::size_t n = data.velocity.size();
    for (std::size_t k = 0; k < n; ++k) {
      const double depth = data.mass_above[k] / data.density;
      const Scalar u = continuum::bagnold_velocity(x[0], x[1], tau_c, c, base_depth, depth);
      r[k] = (u - data.velocity[k]) / errors.velocity[k];
      const Scalar rate = continuum::bagnold_shear_rate(x[0], x[1], data.shear_stress[k]);
      r[n + k] = (rate - data.shear_rate[k]) / errors.shear_rate[k];
    }
  }
};

/// Everything one run gives to the fits.
struct BagnoldInput {
  BagnoldData data;
  BagnoldErrors errors;
  std::vector<BagnoldData> blocks;
  std::array<double, 3> start{};  ///< a, b, mass below: the best Bagnold profile
  double mass_below_base = 0.0;   ///< flowing mass below z = 0, in the pockets of the base
};

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

/// Effective variance of the shear rates at the law x: their own and that of the stress at which
/// the law is taken, s_gd^2 + (d gd/d tau s_tau)^2.
BagnoldErrors effective_errors(const BagnoldInput& input, std::span<const double> x) {
  BagnoldErrors errors = input.errors;
  for (std::size_t k = 0; k < errors.shear_rate.size(); ++k) {
    const double rate = continuum::bagnold_shear_rate(x[0], x[1], input.data.shear_stress[k]);
    const double slope = 1.0 / (x[1] + 2.0 * x[0] * rate);
    errors.shear_rate[k] = std::hypot(errors.shear_rate[k], slope * errors.shear_stress[k]);
  }
  return errors;
}

template <int N>
LeastSquaresProblem problem_at(const BagnoldInput& input,
                               const std::optional<double>& fixed_mass_below,
                               std::span<const double> x) {
  LeastSquaresProblem problem;
  problem.unknowns = {{"a", x[0], 0.0}, {"b", x[1], 0.0}};
  // u = 0 below the base top would be slip, which an effective base cannot express.
  if (N == 3) problem.unknowns.push_back({"mass_below", x[2], input.mass_below_base});
  problem.residuals = static_cast<int>(2 * input.data.velocity.size());
  problem.evaluate =
      differentiate<N>(BagnoldModel{input.data, effective_errors(input, x), fixed_mass_below});
  return problem;
}

/// Scatter of the weighted residuals over the blocks of the run at the law x: rows l with sum l l'
/// = covariance of the residuals of the mean rows. It holds every correlation there is, between
/// bins and between velocity, shear rate, stress and density.
template <int N>
Matrix block_noise(const BagnoldInput& input,
                   const std::optional<double>& fixed_mass_below,
                   std::span<const double> x) {
  const int count = static_cast<int>(input.blocks.size());
  const int width = static_cast<int>(2 * input.data.velocity.size());
  Matrix noise(count, width);
  std::vector<double> mean(static_cast<std::size_t>(width));
  std::array<double, N> at{};
  std::copy_n(x.begin(), N, at.begin());
  for (int b = 0; b < count; ++b) {
    const BagnoldModel model{
        input.blocks[static_cast<std::size_t>(b)], effective_errors(input, x), fixed_mass_below};
    const std::span<double> row(&noise(b, 0), static_cast<std::size_t>(width));
    model(at, row);
    for (std::size_t i = 0; i < row.size(); ++i) mean[i] += row[i] / count;
  }
  const double scale = 1.0 / std::sqrt(count * (count - 1.0));
  for (int b = 0; b < count; ++b) {
    for (int i = 0; i < width; ++i) {
      noise(b, i) = scale * (noise(b, i) - mean[static_cast<std::size_t>(i)]);
    }
  }
  return noise;
}

struct Solved {
  Minimum minimum;
  Uncertainty uncertainty;
};

template <int N>
Solved solve(const BagnoldInput& input, const std::optional<double>& fixed_mass_below) {
  Solved solved;
  solved.minimum = minimise_reweighted(
      [&](std::span<const double> x) { return problem_at<N>(input, fixed_mass_below, x); },
      {input.start.begin(), input.start.begin() + N});
  const std::vector<double>& x = solved.minimum.values;
  const LeastSquaresProblem problem = problem_at<N>(input, fixed_mass_below, x);
  solved.uncertainty =
      input.blocks.empty()
          ? uncertainty(problem, solved.minimum)
          : uncertainty(problem, solved.minimum, block_noise<N>(input, fixed_mass_below, x));
  return solved;
}

/// Residuals far beyond their errors mean a law that is not this one, which no scatter of the data
/// can show in the errors of its coefficients.
void note_misfit(FitSummary& summary) {
  const double rms = std::sqrt(summary.chi_squared / summary.data);
  if (rms <= 2.0) return;
  std::ostringstream text;
  text.precision(2);
  text << "the residuals are " << rms
       << " standard errors on average: the law does not follow the profile to within its scatter; "
          "the errors of the coefficients hold the scatter only";
  summary.notes.push_back(text.str());
}

FitSummary summarise(const Solved& solved,
                     const std::vector<std::string>& names,
                     const BagnoldInput& input,
                     const Observations& observations) {
  FitSummary summary = describe(names, solved.minimum, solved.uncertainty);
  summary.left_out = observations.left_out;
  summary.left_out.emplace_back("tau_c: the grains have no cohesion");
  if (input.blocks.empty()) {
    summary.notes.emplace_back(
        "the run has no frames to form blocks from: errors take all rows as independent and are "
        "too small");
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    if (!solved.minimum.at_bound[j]) continue;
    summary.notes.push_back(names[j] +
                            " is held at its bound, the free optimum lies beyond; its error is "
                            "one-sided");
  }
  note_misfit(summary);
  return summary;
}

/// Xi = b / (a gd) at the stress of half the mass, as a function of a and b.
struct Ratio {
  double half_stress;

  template <class Scalar, std::size_t N>
  void operator()(const std::array<Scalar, N>& x, std::span<Scalar> result) const {
    result[0] = x[1] / (x[0] * continuum::bagnold_shear_rate(x[0], x[1], half_stress));
  }
};

dem::Estimate ratio_mid_depth(const Solved& solved, const BagnoldInput& input) {
  if (!(solved.minimum.values[0] > 0.0)) {
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  double value = 0.0;
  std::array<double, 2> slope{};
  differentiate<2>(Ratio{0.5 * input.data.weight_down * input.data.mass})(
      solved.minimum.values, {&value, 1}, slope);
  const Matrix& c = solved.uncertainty.covariance;
  const double variance = slope[0] * slope[0] * c(0, 0) + 2.0 * slope[0] * slope[1] * c(0, 1) +
                          slope[1] * slope[1] * c(1, 1);
  return {value, std::sqrt(variance)};
}

/// Replaces the mass below the no-slip height by what a table states: the height [d] and the mass
/// [rho_p d]. Both follow from one measured number, d height / d mass = 1 / rho there.
void express_base(const dem::LocalData& run, Solved& solved) {
  const dem::ChuteConditions& grains = run.conditions;
  const MassColumn column(run.rows, grains.grain_density);
  const double above = grains.mass_per_area - solved.minimum.values[2];
  const double step = 1e-3 * grains.grain_density * grains.grain_diameter;  // well inside one bin
  const double height_per_mass =
      (column.height(above - step) - column.height(above + step)) / (2.0 * step);
  const double mass_unit = grains.grain_density * grains.grain_diameter;
  const std::array<double, 4> factor{
      1.0, 1.0, height_per_mass / grains.grain_diameter, 1.0 / mass_unit};
  const std::array<int, 4> from{0, 1, 2, 2};
  Matrix covariance(4, 4);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      covariance(i, j) = factor[i] * factor[j] * solved.uncertainty.covariance(from[i], from[j]);
    }
  }
  solved.uncertainty.covariance = covariance;
  solved.uncertainty.identifiable.push_back(solved.uncertainty.identifiable[2]);
  solved.minimum.at_bound.push_back(solved.minimum.at_bound[2]);
  solved.minimum.values = {solved.minimum.values[0],
                           solved.minimum.values[1],
                           std::max(0.0, column.height(above) / grains.grain_diameter),
                           solved.minimum.values[2] / mass_unit};
}

continuum::RheologyTable make_table(const dem::LocalData& run,
                                    const Observations& observations,
                                    const Solved& solved,
                                    const std::vector<std::string>& names) {
  const std::vector<double>& x = solved.minimum.values;
  continuum::RheologyTable table;
  table.law = continuum::GeneralisedBagnold{.a = x[0],
                                            .b = x[1],
                                            .tau_c = 0.0,
                                            .volume_fraction = observations.bulk_volume_fraction,
                                            .inclination = run.conditions.inclination};
  table.contact_friction = run.conditions.contact_friction;
  table.base = continuum::EffectiveBase{
      .no_slip_height = x[2], .mass_below = x[3], .recipe = run.conditions.base};
  if (solved.uncertainty.null_space.empty()) {
    table.covariance = continuum::Covariance{names, solved.uncertainty.covariance.values};
  }
  table.range.inertial_number = range(run, observations, &LocalRow::inertial_number);
  table.range.softness = range(run, observations, &LocalRow::softness);
  table.provenance = {.source = "grainlaw, generalised Bagnold fit to one run",
                      .data = {run.name},
                      .checked_against = {}};
  return table;
}

}  // namespace

BagnoldFit fit_bagnold(const dem::LocalData& data, const RowSelection& selection) {
  const auto clock = std::chrono::steady_clock::now();
  const Observations observations = select_rows(data, selection);
  const BagnoldInput input = prepare(data, observations);

  Solved free = solve<3>(input, std::nullopt);
  const Solved fixed = solve<2>(input, input.mass_below_base);
  require_converged(free.minimum, data.name);
  require_converged(fixed.minimum, data.name);

  BagnoldFit fit;
  fit.ratio_mid_depth = ratio_mid_depth(free, input);
  fit.ratio_mid_depth_fixed = ratio_mid_depth(fixed, input);
  express_base(data, free);
  const std::vector<std::string> names{"a", "b", "no_slip_height", "mass_below"};
  fit.summary = summarise(free, names, input, observations);
  fit.fixed_base_summary = summarise(fixed, {"a", "b"}, input, observations);
  fit.table = make_table(data, observations, free, names);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - clock;
  fit.summary.wall_seconds = elapsed.count();
  return fit;
}

}  // namespace grainlaw::calibration
