#pragma once

#include <optional>
#include <string>

#include "apps/io/scene_input.h"
#include "apps/summary.h"
#include "dem/local_data.h"

namespace grainlaw {

/// Wall time of a run on one thread [s].
struct RunTime {
  double least = 0.0;  ///< steady at once
  double most = 0.0;   ///< up to the time limit
};

/// Estimate from a short measurement of some steps.
RunTime run_time(const dem::Scene& scene);

/// What a scene will use and leave out, its time step and why, memory and run time (--check).
Summary check_scene(const io::SceneFile& file, const RunTime& time);

/// "steady in 42 s: ...", one line about a finished run.
std::string outcome_line(const dem::LocalData& data);

/// Independent samples of the velocity at its worst height, where they are so few that standard
/// errors are rough; absent otherwise and for runs that are not steady.
std::optional<int> few_samples(const dem::LocalData& data);

/// The results of a run in a few lines.
Summary describe(const dem::LocalData& data);

}  // namespace grainlaw
