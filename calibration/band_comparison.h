#pragma once

#include <optional>
#include <vector>

#include "calibration/comparison.h"
#include "calibration/nonlocal_fit.h"
#include "calibration/state_comparison.h"
#include "continuum/shear_band.h"

namespace grainlaw::calibration {

/// Where the velocities of the two walls of a plane shear are met, as the profile shows it: bumpy
/// walls do not hold the grains at their tops. Both count into the layer; the lower one stays 0
/// where the lower quarter of the layer creeps.
struct NoSlipHeights {
  double lower = 0.0;  ///< above z = 0 [length]
  double upper = 0.0;  ///< below the height of the predicted layer [length]
};

/// What lies farther from a wall is no property of the wall: the shape itself is wrong then.
inline constexpr double farthest_no_slip = 2.0;  // [d]

/// A measured shear band beside a predicted one.
struct BandComparison {
  ProfileError profile;  ///< surface_velocity is not a number, and in the box flux neither
  dem::Estimate width;   ///< measured thickness that takes 90 % of the velocity [length]
  /// What the solver sought: the shear stress (wall of given speed) or the largest velocity (box,
  /// wall of given stress), measured, and predicted / measured - 1.
  dem::Estimate drive;
  dem::Estimate drive_difference;
  double height = 0.0;  ///< measured, of the layer or of the period [length]
  /// Absent: no walls, farther than farthest_no_slip, or a local band that collapsed.
  std::optional<NoSlipHeights> no_slip;
  ErrorBudget budget;
};

/// The rows of a run with positions and velocities as ShearBand::profile counts them: of a box the
/// mean velocity of the mass is subtracted (its momentum is zero but for what the start left) and
/// the period stretched to that of the prediction; phi and mu of plane shear count where the kernel
/// does not reach a wall.
MeasuredRows band_rows(const dem::LocalData& measured,
                       const continuum::ShearBandCase& band,
                       double predicted_height);

/// Throws FitError when one side has no profile.
BandComparison compare_band(const dem::LocalData& measured,
                            const continuum::ShearBandCase& band,
                            const continuum::ShearBand& predicted);

/// Velocities to fit the nonlocal amplitude to: one row per 2 w of the kernel, off the walls.
std::vector<BandPoint> band_points(const dem::LocalData& measured,
                                   const continuum::ShearBandCase& band,
                                   double predicted_height);

}  // namespace grainlaw::calibration
