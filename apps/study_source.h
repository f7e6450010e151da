#pragma once

#include <vector>

#include "apps/io/study_input.h"
#include "apps/study_runs.h"

namespace grainlaw::study {

/// The scene to run, under the name "run"; none where the run is finished.
std::vector<io::SceneFile> source_scenes(const io::RunSource& source);

/// The finished run, whose CPU seconds are not known (NaN), or the runs of the scenes. Throws
/// NoAnswer where one of them failed or is not steady; InputError, Stopped.
std::vector<Run> obtain(const io::RunSource& source,
                        const std::vector<io::SceneFile>& scenes,
                        const Context& context);

}  // namespace grainlaw::study
