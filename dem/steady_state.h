#pragma once

#include <cstddef>
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
  bool mean_flow = true;          ///< judged too; false: a box that flows both ways
};

/// Where a run stands after some frames.
struct Assessment {
  FlowState state = FlowState::too_short;
  bool certain = false;         ///< more time will not change it
  std::size_t first_frame = 0;  ///< of the window that was judged
  std::string reason;
};

/// Judges the mean velocity, kinetic energy and centre of mass of the frames. The start is cut by
/// the marginal standard error rule (latest cut of the three) and by three relaxation times, the
/// time to 1 - 1/e of the velocity that follows: a slow approach to the steady state hides in the
/// noise of a short window, and 5 % of it are left then. The rest is steady when it is at least
/// averaging_time long and no straight line through it drifts at 99 % confidence.
Assessment assess(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria);

/// The window of an assessment.
SteadyWindow steady_window(const Assessment& assessment, std::span<const ProfileFrame> frames);

}  // namespace grainlaw::dem
