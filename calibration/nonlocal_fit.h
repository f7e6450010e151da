#pragma once

#include <functional>
#include <vector>

#include "calibration/fit_summary.h"
#include "continuum/shear_band.h"

namespace grainlaw::calibration {

/// Measured velocity at one position of a shear band, as ShearBand::profile counts positions.
struct BandPoint {
  double position = 0.0;  ///< z, y or r [length]
  double velocity = 0.0;  ///< [length/time]
  double error = 0.0;     ///< standard error of the velocity, positive
};

/// The amplitude A of the nonlocal granular fluidity from one shear band.
struct NonlocalFit {
  double amplitude = 0.0;  ///< A
  double error = 0.0;      ///< standard error; one-sided where A is at its bound 0
  int points = 0;
  double local_chi_squared = 0.0;  ///< of A = 0 on the same points: what nonlocality gains
  FitSummary summary;
};

/// Velocities at the points for an amplitude A >= 0; none where nothing flows.
using VelocityModel = std::function<std::vector<double>(double amplitude)>;

/// Least squares on the velocities, mu(I) and phi(I) held at the table: their errors are not in
/// that of A, which also takes the points as independent. Throws FitError for fewer than 4 points,
/// a point without a standard error, where the fit does not converge, or a band that does not tell
/// A.
/// `step`: of A in central differences, in which the rounding of the model drowns.
NonlocalFit fit_nonlocal_amplitude(const std::vector<BandPoint>& points,
                                   const VelocityModel& model,
                                   double step);

/// The same for a shear band.
NonlocalFit fit_nonlocal_amplitude(const continuum::RheologyTable& table,
                                   const continuum::ShearBandCase& band,
                                   const std::vector<BandPoint>& points);

}  // namespace grainlaw::calibration
