#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "continuum/answer.h"
#include "continuum/profile.h"
#include "continuum/rheology.h"
#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

/// An inclined layer, given by what is known before it flows.
struct ChuteCase {
  double inclination = 0.0;    ///< theta [rad]
  double gravity = 1.0;        ///< g [length/time^2]
  double mass_per_area = 0.0;  ///< M0, all flowing mass above the base [mass/length^2]
  GrainProperties grains{};
};

struct SteadyOptions {
  int panels = 16;  ///< of 6-point Gauss quadrature over the sheared part
  int rows = 101;   ///< of the profile returned
};

struct SteadyChute {
  Answer answer;
  Profile profile;  ///< empty unless the outcome is steady or plug
};

/// Steady profile by quadrature in the mass coordinate, u = 0 at the effective base of the table:
/// u(M) = int_M^M1 I sqrt(p/rho_p) / (d rho_p phi) dM', M1 = M0 - mass below the no-slip height.
/// Relative error 1e-13 for analytic laws. The profile starts at the no-slip height.
/// Throws TableError for a table that validate() refuses and std::invalid_argument for a case
/// without meaning (p = 0, M0 <= 0).
SteadyChute steady_chute(const RheologyTable& table,
                         const ChuteCase& chute,
                         const SteadyOptions& options = {});

/// Fills velocity_error and volume_fraction_error of a steady profile by linear propagation of the
/// table's covariance: one standard error at the height z of the row, which includes that of the
/// no-slip height. Leaves the profile untouched when the table states no errors.
void add_error_band(SteadyChute& steady, const RheologyTable& table, const ChuteCase& chute);

struct TransientOptions {
  int cells = 200;
  double grading = 1.5;  ///< faces at M1 (k/N)^grading from the surface
  double relative_tolerance = 1e-6;
  double absolute_tolerance = 1e-10;  ///< of the scaled shear rate
  /// delta of tau_y q / sqrt(q^2 + delta^2), where q is I for mu(I) laws and gd sqrt(d/g) else;
  /// 0: 1e-4 of the steady q at the base. Used only by laws whose yield stress is not proportional
  /// to depth, and then named in the answer together with the error it causes.
  double yield_regularisation = 0.0;
  double time_limit = 0.0;  ///< [time]; 0: five times the settling time, and at least the last
                            ///< output time
  /// Steady when max |du/dt| <= this times g sin(theta), not before the settling time: relaxation
  /// time times ln(1 / steady_residual).
  double steady_residual = 1e-8;
  std::vector<double> output_times{};  ///< snapshots wanted [time]
  bool stop_when_steady = true;        ///< once all snapshots are taken; false: run to time_limit
};

struct Snapshot {
  double time = 0.0;
  Profile profile;
};

struct TransientChute {
  Answer answer;                    ///< of the state at the end of the run
  Profile final_profile;            ///< empty where the law has left physics
  std::vector<Snapshot> snapshots;  ///< at the output times that were reached
  double end_time = 0.0;            ///< [time]
  /// Estimate made before the run: when a start will be over but for steady_residual; 0 where no
  /// steady flow lies ahead [time]
  double settling_time = 0.0;
  /// Time at which the mean velocity came within 1 % of its final value to stay; absent unless the
  /// run ended steady [time]
  std::optional<double> time_to_steady{};
  double residual = 0.0;  ///< max |du/dt| / (g sin(theta)) at the end
  SolverStatistics statistics;
};

/// Start of the layer from rest, du/dt = g sin(theta) - dtau/dM, by the method of lines: scaled
/// shear rate at the faces as state, CVODE BDF with banded analytic Jacobian. Rows at the base, the
/// cell centres and the surface; second order in 1/cells. A layer below repose is ARRESTED at once;
/// one whose softness takes all friction is NO_STEADY without a profile. Shear rates only rise from
/// rest (the equation is parabolic and its rate starts positive), so the range flags of the state
/// at the end tell the highest I and the lowest phi of the whole run.
/// Throws TableError and std::invalid_argument like steady_chute, and SolverError when CVODE fails;
/// the message names cell, variable and time.
TransientChute start_from_rest(const RheologyTable& table,
                               const ChuteCase& chute,
                               const TransientOptions& options = {});

}  // namespace grainlaw::continuum
