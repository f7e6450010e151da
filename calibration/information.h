#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/material_fit.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// What one run adds to the knowledge of a law.
struct RunInformation {
  std::string run;
  int points = 0;             ///< of it that were fitted
  double wall_seconds = 0.0;  ///< 0: not known
  /// Rise of ln det(covariance) when the run is left out, natural units of information; infinite:
  /// without it a coefficient is unknown.
  double gain = 0.0;
  double gain_per_second = 0.0;        ///< NaN where the cost is not known
  std::vector<double> error_increase;  ///< of each coefficient when the run is left out, relative
};

/// What the runs of a law tell about its coefficients, to first order at the fit: from the weighted
/// Jacobian, without a new fit per run.
struct LawInformation {
  std::vector<std::string> coefficients;  ///< as in the summary of the fit
  std::vector<RunInformation> runs;       ///< most gain per second first, unknown cost last
};
LawInformation friction_information(std::span<const StatePoint> points, const MaterialFit& fit);
LawInformation fraction_information(std::span<const StatePoint> points, const MaterialFit& fit);

/// Coefficients from a part of the averaging time of all runs, fitted anew.
struct CostPoint {
  double share = 1.0;                          ///< of the steady window of every run
  double dem_wall_seconds = 0.0;               ///< all runs until there, start-up included
  std::vector<dem::Estimate> friction;         ///< in the order of the summary of the fit
  std::vector<dem::Estimate> volume_fraction;  ///< likewise
  double friction_scatter = 1.0;  ///< rms of the points about the law in their errors; well above
                                  ///< 1 where the law, not the time, limits; NaN: not tested,
                                  ///< or no point has an error
  double fraction_scatter = 1.0;
  std::string failure;  ///< not empty: no fit was possible with so little, and why
};

/// Both laws with the terms of `fit` from 1/16, 1/8, 1/4, 1/2 and all of the averaging time of the
/// runs behind its points. Empty where no run has frames to average anew.
std::vector<CostPoint> cost_of_coefficients(std::span<const dem::LocalData> runs,
                                            std::span<const StatePoint> points,
                                            const MaterialFit& fit);

}  // namespace grainlaw::calibration
