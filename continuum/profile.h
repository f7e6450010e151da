#pragma once

#include <vector>

namespace grainlaw::continuum {

/// One height of a flow profile, bottom to top.
struct ProfileRow {
  double z = 0.0;                ///< above the base plane [length]
  double mass_above = 0.0;       ///< per unit area [mass/length^2]
  double velocity = 0.0;         ///< v_x [length/time]
  double shear_rate = 0.0;       ///< [1/time]
  double shear_stress = 0.0;     ///< sigma_xz [stress]
  double pressure = 0.0;         ///< sigma_zz [stress]
  double volume_fraction = 0.0;  ///< phi
  double inertial_number = 0.0;  ///< I
  double velocity_error = 0.0;   ///< one standard error from the table's covariance; 0: none stated
  double volume_fraction_error = 0.0;  ///< likewise for phi
};

/// What the solver did.
struct SolverStatistics {
  long steps = 0;
  long rhs_evaluations = 0;
  long jacobian_evaluations = 0;
  long error_test_failures = 0;
  long newton_failures = 0;
  double wall_seconds = 0.0;

  SolverStatistics& operator+=(const SolverStatistics& other) {
    steps += other.steps;
    rhs_evaluations += other.rhs_evaluations;
    jacobian_evaluations += other.jacobian_evaluations;
    error_test_failures += other.error_test_failures;
    newton_failures += other.newton_failures;
    wall_seconds += other.wall_seconds;
    return *this;
  }
};

struct Profile {
  std::vector<ProfileRow> rows;
  double height = 0.0;            ///< of the free surface above the base plane [length]
  double surface_velocity = 0.0;  ///< [length/time]
  double flux = 0.0;              ///< int phi v dz [length^2/time]
  double plug_mass = 0.0;         ///< mass per area above the plug edge; 0: no plug
};

}  // namespace grainlaw::continuum
