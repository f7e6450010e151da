#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "dem/local_data.h"
#include "dem/profile_frames.h"

namespace grainlaw::dem {

enum class FlowState { too_short, drifting, accelerating, arrested, steady };
std::string_view name(FlowState state);

/// What the detector has to know of the run.
struct SteadyCriteria {
  double averaging_time = 200.0;  ///< least length of a steady window [time]
  double rest_velocity = 1e-3;    ///< slower than this for rest_time: arrested [length/time]
  double rest_time = 20.0;        ///< [time]
  double runaway_velocity = 1e9;  ///< faster than any dense flow, still speeding up: accelerating
  double start_up = 0.0;          ///< the window begins no earlier [time]
  double last_change = 0.0;       ///< of the drive: what was before it tells nothing [time]
  bool mean_flow = true;          ///< judged too; false: a box that flows both ways
  double compaction = 0.0;        ///< share by which the centre of mass may drift in the window
  double drive = 0.0;             ///< what friction has to balance, per mass [length/time^2]
};

/// Where a run stands after some frames.
struct Assessment {
  FlowState state = FlowState::too_short;
  bool certain = false;         ///< more time will not change it
  std::size_t first_frame = 0;  ///< of the window that was judged
  std::string reason{};
  std::optional<double> arrested_at{};  ///< begin of the rest it is in [time]
};

/// Judges the mean velocity, the velocities of the lowest, middle and highest third of the mass
/// (the profile may still drift where its mean does not; not judged of fewer than three bins), the
/// kinetic energy and the centre of mass of the frames.
/// The start is cut by the marginal standard error rule (latest cut of them all) and by three
/// relaxation times of the slowest of the velocities, the time in which all but 1/e of the way to
/// its later mean is gone: a slow approach to the steady state hides in the noise of a short
/// window. More is cut until what is left of the approach moves no mean velocity by more than its
/// standard error. The rest is steady when it is at least averaging_time long and no straight line
/// through any of the series drifts at 99 % confidence. A drift is seen from about nine standard
/// errors of the mean on; frames that do not hold the beginning of a slow approach do not tell that
/// they end one. Under a drive the mean velocity must also be known to gain or lose less than 5 %
/// of it: where friction and drive may differ by more, no drift that is seen tells little. A flow
/// that is steady while it compacts says so in its reason. Frames that begin before the last change
/// of the drive are not judged.
Assessment assess(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria);

/// The window of an assessment.
SteadyWindow steady_window(const Assessment& assessment, std::span<const ProfileFrame> frames);

}  // namespace grainlaw::dem
