#pragma once

#include <optional>
#include <span>
#include <vector>

#include "apps/report/report.h"
#include "calibration/comparison.h"

namespace grainlaw {

/// Same grains on the same base: diameter, density, stiffness, contact friction, recipe.
bool same_grains(const dem::ChuteConditions& a, const dem::ChuteConditions& b);

using calibration::chute_case;

/// Steady quadrature with band, and CVODE through the tilts of a run.
struct Prediction {
  continuum::SteadyChute steady;
  std::optional<continuum::TransientChute> transient;  ///< absent where nothing moves
  double steady_against_transient = 0.0;  ///< max |u_quadrature - u_CVODE| / surface velocity
  double wall_seconds = 0.0;
};
/// Of the chute of a run: the steady flow of its last tilt, and its history from rest or, where the
/// run began in motion, from the steady flow of its first tilt, at the middle of its frames.
Prediction predict_chute(const continuum::RheologyTable& table, const dem::LocalData& data);

/// Prediction of one run beside its data. `fitted` are the runs the table was fitted to (empty when
/// it came from elsewhere): they tell in sample from out of sample and give the naive guess.
report::RunComparison compare_run(const dem::LocalData& data,
                                  const continuum::RheologyTable& table,
                                  std::span<const dem::LocalData> fitted);

/// Every fitted chute predicted by the law refitted without its tilt. Empty for fewer than three
/// tilts, as a law needs two; a refit that fails is left out.
std::vector<report::RunComparison> leave_one_out(std::span<const dem::LocalData> fitted);

/// Error of law and predictions as the averaging time of the fitted runs grows from one sixteenth
/// to all of it; errors of the law are against the fit to everything.
std::vector<report::TimeErrorPoint> error_against_time(std::span<const dem::LocalData> fitted,
                                                       std::span<const dem::LocalData> all,
                                                       const continuum::RheologyTable& final_table);

}  // namespace grainlaw
