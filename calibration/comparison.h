#pragma once

#include <string_view>
#include <vector>

#include "continuum/chute_1d.h"
#include "continuum/profile.h"
#include "dem/estimate.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// How a run relates to the data a law was fitted to; never mixed in one number.
enum class SampleKind {
  in_sample,       ///< fitted to this very run
  leave_one_out,   ///< fitted again without it
  interpolation,   ///< same geometry, between the fitted states
  extrapolation,   ///< same geometry, beyond them
  cross_geometry,  ///< fitted to flows of another geometry
  independent,     ///< a table of elsewhere
};

std::string_view name(SampleKind kind);  ///< "in sample", "left out", ..., "independent table"

/// in_sample: the tilt was fitted; interpolation: between fitted tilts; extrapolation: beyond them;
/// independent: none of the runs at hand was fitted.
SampleKind sample_kind(double inclination, const std::vector<double>& fitted_inclinations);

/// Distance between a measured and a predicted profile of one run. All relative errors are
/// sqrt(int (predicted - measured)^2 dz / int measured^2 dz) over the bins from z = 0 (base layer
/// included) up to where phi falls below half its bulk value. The standard errors hold the
/// scatter of the DEM profile only (jackknife over its blocks).
struct ProfileError {
  dem::Estimate velocity;           ///< relative L2
  dem::Estimate velocity_maximum;   ///< largest |difference| over the largest measured velocity
  dem::Estimate volume_fraction;    ///< relative L2
  dem::Estimate friction;           ///< relative L2 of mu = sigma_xz / sigma_zz
  dem::Estimate surface_velocity;   ///< relative difference, signed, at the highest compared bin
  dem::Estimate flux;               ///< relative difference of int phi v dz, signed
  double in_standard_errors = 0.0;  ///< root mean square velocity residual over its standard error
};

/// Errors are NaN without frames to make blocks from. Throws FitError when one side has no rows.
ProfileError profile_error(const dem::LocalData& measured, const continuum::Profile& predicted);

/// Velocity of a continuum profile at height z, 0 below its no-slip height, the surface value
/// above.
double velocity_at(const continuum::Profile& profile, double z);

/// What one would guess without a law: the measured profile of the nearest fitted tilt, height
/// scaled by the mass ratio r, velocity by r^1.5 sqrt(sin(theta) / sin(theta_near)), i.e. Bagnold
/// with the coefficient a of the nearest tilt kept.
continuum::Profile naive_guess(const dem::LocalData& nearest, const dem::ChuteConditions& target);

/// Transient velocity profiles side by side: DEM frames against continuum snapshots.
struct TransientError {
  double time = 0.0;            ///< [time]
  double measured_mean = 0.0;   ///< mass-averaged velocity, DEM [length/time]
  double predicted_mean = 0.0;  ///< same, continuum
  double velocity_error =
      0.0;  ///< L2 of u(z) at this time over the L2 of the steady measured profile
};

/// One row for each snapshot whose time lies in a frame. Frames are means over time: ask for
/// snapshots at their middle.
std::vector<TransientError> transient_error(const dem::LocalData& measured,
                                            const std::vector<continuum::Snapshot>& predicted);

}  // namespace grainlaw::calibration
