#include "calibration/ratio_of_law.h"

#include <algorithm>
#include <cmath>

#include "calibration/bagnold_solve.h"
#include "calibration/comparison.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

/// Stress and shear rate of the flow that a law predicts at the masses of the measured rows, with
/// their weights; rows in its plug are left out. Nothing where fewer than four flow.
std::optional<BagnoldInput> as_predicted(const BagnoldInput& measured,
                                         const dem::ChuteConditions& grains,
                                         const continuum::RheologyTable& table) {
  const auto rows = continuum::steady_chute(table, chute_case(grains), {.rows = 401}).profile.rows;
  BagnoldInput input = measured;
  input.data.velocity.clear();
  input.data.shear_stress.clear();
  input.data.shear_rate.clear();
  input.errors = {};
  input.blocks.clear();
  for (std::size_t k = 0; k < measured.data.mass_above.size(); ++k) {
    const double mass = measured.data.mass_above[k];
    const auto above =
        std::ranges::find_if(rows, [&](const auto& row) { return row.mass_above < mass; });
    if (above == rows.begin() || above == rows.end()) continue;
    const continuum::ProfileRow& below = *(above - 1);
    const double share = (below.mass_above - mass) / (below.mass_above - above->mass_above);
    const double rate = std::lerp(below.shear_rate, above->shear_rate, share);
    if (!(rate > 0.0)) continue;
    input.data.velocity.push_back(0.0);  // not looked at
    input.data.shear_rate.push_back(rate);
    input.data.shear_stress.push_back(std::lerp(below.shear_stress, above->shear_stress, share));
    input.errors.shear_rate.push_back(measured.errors.shear_rate[k]);
    input.errors.shear_stress.push_back(measured.errors.shear_stress[k]);
  }
  if (input.data.shear_rate.size() < 4) return std::nullopt;
  return input;
}

}  // namespace

std::optional<double> ratio_of_law(const dem::LocalData& run,
                                   const continuum::RheologyTable& table) {
  Observations rows = select_rows(run, {});
  const auto plug = find_plug(run, rows);
  if (plug) leave_out_plug(run, *plug, rows);
  const auto predicted = as_predicted(prepare(run, rows), run.conditions, table);
  if (!predicted) return std::nullopt;
  const SolvedBagnold solved =
      solve_bagnold(*predicted, stress_rate_pairs(run.conditions.attraction > 0.0));
  return stress_ratio(solved, *predicted, 0.5).value;
}

}  // namespace grainlaw::calibration
