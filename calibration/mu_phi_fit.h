#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/fit_summary.h"
#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// The single independent point that one steady chute gives: depth rows of one chute share mu and I
/// and are not independent.
struct FlowPoint {
  std::string name;
  double inclination = 0.0;  ///< [rad]
  dem::Estimate friction;    ///< mu = sigma_xz / sigma_zz through the bulk (tan theta in balance)
  dem::Estimate inertial_number;  ///< from the velocity profile with its own no-slip height
  dem::Estimate volume_fraction;  ///< bulk phi
  dem::Estimate no_slip_height;   ///< [d]
  dem::Estimate mass_below;       ///< [rho_p d]
  double softness_lower = 0.0;    ///< p* of the flowing layer: 0 at its surface
  double softness_upper = 0.0;
  int blocks = 0;  ///< independent stretches of time the errors rest on; 0: errors from the rows
  std::vector<std::string> left_out;  ///< sentences: rows that did not count
  std::vector<std::string> notes;     ///< sentences: what a reader must know of this point
};

/// The laws mu(I), phi(I) over all tilts, closure (B).
struct MuPhiFit {
  continuum::RheologyTable table;
  std::vector<FlowPoint> points;
  FitSummary friction;  ///< mu0, beta, kappa (kappa dropped and said so when not identifiable)
  FitSummary volume_fraction;  ///< phi0, I_phi
};

/// Measures the point of one run. Throws FitError like fit_bagnold.
FlowPoint flow_point(const dem::LocalData& data, const RowSelection& selection = {});

/// Where the run's own velocities reach 0. A table's layer begins at the top of the base at the
/// lowest: grains that slip there, whose velocities point below it, have u = 0 at the top.
continuum::EffectiveBase effective_base(const FlowPoint& point);

/// Friction as a law uses it: tan(theta) without error where the measured one agrees with it within
/// three standard errors (exact in steady flow by the balance of forces), else the measured one.
dem::Estimate friction_for_fit(const FlowPoint& point);

/// Fits mu(I) and phi(I) with errors in both axes (effective variance). Needs at least two runs at
/// different tilts. Throws FitError.
MuPhiFit fit_mu_phi(std::span<const dem::LocalData> runs, const RowSelection& selection = {});

/// The same fit to points that were made of these runs, e.g. means over runs that differ in their
/// seed only.
MuPhiFit fit_mu_phi(std::span<const dem::LocalData> runs, std::vector<FlowPoint> points);

}  // namespace grainlaw::calibration
