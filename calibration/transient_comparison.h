#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "continuum/chute_1d.h"
#include "dem/estimate.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// Velocity profiles of one moment side by side: a DEM frame against a continuum snapshot.
struct Moment {
  double time = 0.0;            ///< of the snapshot [time]
  double measured_mean = 0.0;   ///< mass-averaged velocity, DEM [length/time]
  double predicted_mean = 0.0;  ///< same, continuum
  double velocity_error = 0.0;  ///< L2 of the difference of u(z) over Stretch::velocity_norm
};

/// What a layer goes through at one tilt.
enum class Change {
  start,      ///< it sets itself in motion from rest
  tilt_step,  ///< from the flow of one tilt to that of another
  arrest,     ///< it comes to rest, in the DEM, the continuum or both
};

std::string_view name(Change change);  ///< "start", "tilt step", "arrest"

/// Times are known to one frame: its middle, and the standard deviation of a time that may lie
/// anywhere in it. Fluctuations of the DEM flow, which bring a first passage early, are not in that
/// error.
struct TimeToSteady {
  dem::Estimate measured;   ///< since the change, until the mean velocity first comes within
                            ///< `share` of its change of its last value [time]
  dem::Estimate predicted;  ///< likewise, at the same frames
  double share = 0.0;       ///< 5 %, or three standard deviations of the last measured means
};

struct StoppingTime {
  std::optional<dem::Estimate> measured;  ///< since the change; absent: it did not stop [time]
  std::optional<double> predicted;        ///< ARREST of CVODE since the change; absent: likewise
};

/// The part of a chute run at one tilt.
struct Stretch {
  Change change = Change::start;
  double begin = 0.0;                          ///< [time]
  double end = 0.0;                            ///< [time]
  double inclination = 0.0;                    ///< [rad]
  std::optional<double> inclination_before{};  ///< absent: the first tilt, from rest
  /// L2 over the compared rows of the measured velocities at its end or its begin, whichever is
  /// larger: of the steady window at the last tilt, else of the last quarter of the frames.
  double velocity_norm = 0.0;
  std::vector<Moment> moments{};
  double error = 0.0;  ///< root mean square of their velocity errors, up to the later of two stops
  std::optional<TimeToSteady> to_steady{};  ///< absent: one side is not steady at its end
  std::optional<StoppingTime> stop{};       ///< of an arrest
};

/// A chute run from its begin beside the continuum with the same history of tilts, one Moment for
/// each snapshot whose time lies in a frame. Frames are means over time: ask for snapshots at their
/// middle. A first tilt whose flow the run began in is left out: nothing changes there.
std::vector<Stretch> compare_in_time(const dem::LocalData& measured,
                                     const continuum::TransientChute& predicted);

/// The tilts of a run from time 0 on that its frames have seen; one where it was never changed.
std::vector<dem::TiltStep> tilts_of(const dem::LocalData& data);

}  // namespace grainlaw::calibration
