#pragma once

#include <vector>

namespace grainlaw::calibration {

/// u(M) = slope (M1^1.5 - M^1.5): the velocity where the inertial number does not vary with depth,
/// for both a mu(I) law and Bagnold's (M: mass per unit area above, M1: above the no-slip height).
struct PowerProfile {
  double slope = 0.0;         ///< [velocity / (mass/length^2)^1.5]
  double flowing_mass = 0.0;  ///< M1 [mass/length^2]
  double slope_error = 0.0;   ///< standard errors for independent velocities with the given errors
  double flowing_mass_error = 0.0;
};

/// Weighted linear least squares in M^1.5. The slope is not positive, and M1 NaN, when the velocity
/// does not rise towards the surface.
PowerProfile fit_power_profile(const std::vector<double>& mass_above,
                               const std::vector<double>& velocity,
                               const std::vector<double>& error);

}  // namespace grainlaw::calibration
