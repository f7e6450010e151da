#pragma once

#include <functional>

#include "dem/checkpoint.h"
#include "dem/initial_state.h"
#include "dem/local_data.h"
#include "dem/run_error.h"
#include "dem/scene.h"

namespace grainlaw::dem {

/// The state of a run, for a progress line.
struct Progress {
  double time = 0.0;          ///< since the start of the flow [time]
  double expected_end = 0.0;  ///< best present estimate [time]
  long steps = 0;
  double wall_seconds = 0.0;
  double mean_velocity = 0.0;  ///< [length/time]
  bool settling = false;       ///< packing and settling, before the flow starts
};

/// Called between frames; return false to stop the run after this frame (its data are kept). Called
/// a few times a second while the grains are packed and settle; such a run stops at once.
using Observer = std::function<bool(const Progress&)>;

/// All grains at one time, in the order of their numbers.
struct Snapshot {
  double time = 0.0;  ///< since the start of the flow [time]
  InitialState state;
};

/// What a run is asked beside its scene. Nothing here changes the path of the grains.
struct RunOptions {
  Observer observer;
  int threads = 1;
  /// Takes a checkpoint: about every checkpoint_interval seconds of wall time, and when the run is
  /// stopped by the observer: an empty one, or the one it goes on from, where the flow has not
  /// started. Absent: none is made.
  std::function<void(const Checkpoint&)> save;
  double checkpoint_interval = 60.0;  ///< [s]
  /// Takes the grains at the first sample after every multiple of snapshot_interval [time]; a run
  /// that goes on takes them where the others would have. Absent: not made.
  std::function<void(const Snapshot&)> snapshot;
  double snapshot_interval = 1.0;
  const Checkpoint* resume = nullptr;  ///< go on from here instead of from the start
};

/// Conditions of the scene that fits and predictions may use.
ChuteConditions conditions(const Scene& scene);

/// Runs the scene: its start, or a packing that settles first; then it flows until the steady
/// window is long enough or the time limit is reached. Same scene, seed and build: identical
/// numbers. Throws SceneError, StepRefused, RunError; CheckpointError when `resume` does not fit
/// the scene.
LocalData run(const Scene& scene, const RunOptions& options = {});

/// Seconds one step of this scene takes on this machine, from a short measurement.
double measure_step_seconds(const Scene& scene);

}  // namespace grainlaw::dem
