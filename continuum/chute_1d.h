#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "continuum/answer.h"
#include "continuum/profile.h"
#include "continuum/rheology.h"
#include "continuum/rheology_table.h"

namespace grainlaw::continuum {

/// Two vertical walls that the grains slide along: each takes the shear stress friction
/// pressure_ratio p against the flow.
struct SideWalls {
  double width = 0.0;           ///< W between them [length]
  double friction = 0.0;        ///< mu_w
  double pressure_ratio = 1.0;  ///< K = sigma_yy / sigma_zz at the walls
};

/// An inclined layer, given by what is known before it flows.
struct ChuteCase {
  double inclination = 0.0;    ///< theta [rad]
  double gravity = 1.0;        ///< g [length/time^2]
  double mass_per_area = 0.0;  ///< M0, all flowing mass above the base [mass/length^2]
  GrainProperties grains{};
  std::optional<SideWalls> walls{};  ///< absent: wide
  double slip_length = 0.0;          ///< L_s of u = L_s du/dz at the base [length]; 0: no slip
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
/// Relative error 1e-13 for analytic laws. The profile starts at the no-slip height. Between side
/// walls the stress is no longer known beforehand, dtau/dM = g sin(theta) - (2 mu_w K / W) p / rho,
/// and is integrated from the surface down, relative error 1e-9; what the walls hold up rests.
/// Throws TableError for a table that validate() refuses and std::invalid_argument for a case
/// without meaning (p = 0, M0 <= 0).
SteadyChute steady_chute(const RheologyTable& table,
                         const ChuteCase& chute,
                         const SteadyOptions& options = {});

/// Fills velocity_error and volume_fraction_error of a steady profile by linear propagation of the
/// table's covariance: one standard error at the height z of the row, which includes that of the
/// no-slip height. Leaves the profile untouched when the table states no errors.
void add_error_band(SteadyChute& steady, const RheologyTable& table, const ChuteCase& chute);

/// The tilt from some time on.
struct TiltStep {
  double time = 0.0;         ///< [time]
  double inclination = 0.0;  ///< [rad]
};

struct TransientOptions {
  int cells = 200;
  double grading = 1.5;  ///< faces at M1 (k/N)^grading from the surface
  double relative_tolerance = 1e-6;
  double absolute_tolerance = 1e-10;  ///< of the scaled shear rate, or of velocity and stress
  /// The flow at time 0 is the steady one of this tilt [rad]; absent: the layer is at rest.
  std::optional<double> inclination_before{};
  std::vector<TiltStep> tilts{};  ///< tilts that follow the one of the case, in order of time
  /// > 0: delta of a yield stress tau_y q / sqrt(q^2 + delta^2), where q is I for mu(I) laws and
  /// gd sqrt(d/g) else, to study its error; 0: yield is exact.
  double yield_regularisation = 0.0;
  /// Time in which unyielded grains pass on a stress, [time]; 0: 5e-4 of the time the flow takes.
  /// No steady state depends on it; times of start and arrest do by a few of it.
  double elastic_time = 0.0;
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

/// Something that happened at one time.
struct ChuteEvent {
  enum class Kind { start, arrest, dense_state_lost };
  Kind kind = Kind::start;
  double time = 0.0;  ///< [time]
};

std::string_view name(ChuteEvent::Kind kind);  ///< START, ARREST, DENSE_STATE_LOST

struct TransientChute {
  Answer answer;                    ///< of the state at the end of the run
  Profile final_profile;            ///< empty where the law has left physics
  std::vector<Snapshot> snapshots;  ///< at the output times that were reached
  std::vector<ChuteEvent> events;   ///< in order of time
  double end_time = 0.0;            ///< [time]
  /// Estimate made before the run: when a start will be over but for steady_residual; 0 where no
  /// steady flow lies ahead [time]
  double settling_time = 0.0;
  /// Time at which the mean velocity came within 1 % of its final value to stay; absent unless the
  /// run ended steady [time]
  std::optional<double> time_to_steady{};
  /// Surface velocity of the steady quadrature at the last tilt, which knows nothing of the time
  /// integration; absent where no steady flow exists.
  std::optional<double> quadrature_surface_velocity{};
  double residual = 0.0;  ///< max |du/dt| / (g sin(theta)) at the end
  SolverStatistics statistics;
};

/// Time-dependent flow of the layer, du/dt = g sin(theta) - dtau/dM, by the method of lines and
/// CVODE (BDF, banded analytic Jacobian): the start from rest, or what follows the steady flow of
/// another tilt. Where part of the layer may rest while another shears, unyielded grains are
/// elastic, so plug, arrest and rest are exact; else the state is the scaled shear rate. Rows at
/// the base, the cell centres and the surface; second order in 1/cells without a plug. A layer at
/// rest below repose is ARRESTED at once; one whose softness takes all friction is NO_STEADY
/// without a profile. From rest at one tilt shear rates only rise (the equation is parabolic and
/// its rate starts positive), so the range flags of the state at the end tell the highest I and the
/// lowest phi of the whole run. A failure of CVODE is NOT_CONVERGED; the text names place, variable
/// and time. Throws TableError and std::invalid_argument like steady_chute.
TransientChute transient_chute(const RheologyTable& table,
                               const ChuteCase& chute,
                               const TransientOptions& options = {});

/// The same for a layer that is at rest at time 0.
inline TransientChute start_from_rest(const RheologyTable& table,
                                      const ChuteCase& chute,
                                      const TransientOptions& options = {}) {
  return transient_chute(table, chute, options);
}

}  // namespace grainlaw::continuum
