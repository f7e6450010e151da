#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "continuum/chute_1d.h"
#include "continuum/profile.h"
#include "dem/estimate.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// The chute of a run as the continuum solver sees it: only what is known before the run.
continuum::ChuteCase chute_case(const dem::ChuteConditions& conditions);

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
/// sqrt(int (predicted - measured)^2 dz / int measured^2 dz). A chute: over the bins from z = 0
/// (base layer included) up to where phi falls below half its bulk value; phi and mu only up to
/// the reach of the kernel below there, as nearer the surface the kernel mixes the layer with the
/// void above it. The standard errors hold the scatter of the DEM profile only (jackknife over its
/// blocks).
struct ProfileError {
  dem::Estimate velocity;           ///< relative L2
  dem::Estimate velocity_maximum;   ///< largest |difference| over the largest measured velocity
  dem::Estimate volume_fraction;    ///< relative L2
  dem::Estimate friction;           ///< relative L2 of mu = sigma_xz / sigma_zz
  dem::Estimate surface_velocity;   ///< relative difference, signed, at the highest compared bin
  dem::Estimate flux;               ///< relative difference of int phi v dz, signed
  double in_standard_errors = 0.0;  ///< root mean square velocity residual over its standard error
  double statistics = 0.0;  ///< relative L2 of the standard errors of the measured velocities
  double law = 0.0;         ///< relative L2 of the velocity band of the prediction; 0: none stated
  double velocity_top = 0.0;  ///< upper end of the rows whose velocity counts [length]
  double fraction_top = 0.0;  ///< upper end of those whose phi and mu count [length]
};

/// Errors are NaN without frames to make blocks from. Throws FitError when one side has no rows.
ProfileError profile_error(const dem::LocalData& measured, const continuum::Profile& predicted);

/// Relative L2 distance of the velocities of two predictions over the rows of a run whose velocity
/// counts, relative to the measured ones: the part of the error that their difference makes.
double velocity_distance(const dem::LocalData& measured,
                         const continuum::Profile& one,
                         const continuum::Profile& other);

/// Rows of a run that are compared, in the whole window and in each of its independent blocks.
struct MeasuredRows {
  std::vector<dem::LocalRow> rows;
  std::vector<std::vector<dem::LocalRow>> blocks;
  std::vector<bool> dense;  ///< phi and mu of the row count too
};

/// A prediction at the places of those rows.
struct Predicted {
  std::vector<double> velocity;
  std::vector<double> velocity_error;  ///< one standard error; 0: none stated
  std::vector<double> volume_fraction;
  std::vector<double> friction;
};

/// Of a profile, its position counted as the rows count theirs.
Predicted predict_at(const continuum::Profile& profile, const std::vector<dem::LocalRow>& rows);

/// All norms of a prediction; surface velocity is that of the last row.
ProfileError profile_error(const Predicted& predicted, const MeasuredRows& measured);

/// The rows above z = 0 up to where phi falls below half its bulk value, `dense` up to the reach of
/// the kernel below there.
MeasuredRows measured_rows(const dem::LocalData& measured);

/// Velocity of a continuum profile at height z, 0 below its no-slip height, the surface value
/// above.
double velocity_at(const continuum::Profile& profile, double z);

/// Where one error of a predicted velocity profile comes from, all relative L2 of the velocity.
struct ErrorBudget {
  double total = 0.0;       ///< predicted against measured
  double statistics = 0.0;  ///< standard errors of the DEM profile
  double law = 0.0;         ///< band of the table, from its covariance
  double geometry = 0.0;    ///< between the prediction and the same with what the table cannot know
                            ///< of this geometry taken from the run itself: no-slip heights, or,
                            ///< across geometries, the law
  double numerics = 0.0;    ///< discretisation of the solver

  /// What the four do not explain, added in squares: the form of the law and of the model.
  double rest() const;
};

/// A number that follows from a table, with the standard error that the covariance of the table
/// gives to it (linear propagation); without a covariance the error is NaN.
dem::Estimate propagated(const continuum::RheologyTable& table,
                         const std::function<double(const continuum::RheologyTable&)>& number);

/// What one would guess without a law: the measured profile of the nearest fitted tilt, height
/// scaled by the mass ratio r, velocity by r^1.5 sqrt(sin(theta) / sin(theta_near)), i.e. Bagnold
/// with the coefficient a of the nearest tilt kept.
continuum::Profile naive_guess(const dem::LocalData& nearest, const dem::ChuteConditions& target);

}  // namespace grainlaw::calibration
