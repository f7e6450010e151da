#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "apps/io/scene_input.h"
#include "apps/summary.h"
#include "dem/run.h"

namespace grainlaw {

/// What a scene will use and leave out, its time step and why, memory and run time (--check).
Summary check_scene(const io::SceneFile& file);

using ShowProgress = std::function<void(const dem::Progress&)>;

/// Runs a scene and writes its local data, also those of a run that was stopped by a signal or is
/// not steady: the window says so. Throws what dem::run and the writer throw.
dem::LocalData run_scene(const io::SceneFile& file,
                         const std::filesystem::path& output,
                         const ShowProgress& show);

/// Share of a run that is done, 0 to 1, and the wall seconds left by the present rate.
double share_done(const dem::Progress& now);
double seconds_left(const dem::Progress& now);

/// "steady in 42 s: ...", one line about a finished run.
std::string outcome_line(const dem::LocalData& data);

/// Independent samples of the velocity at its worst height, where they are so few that standard
/// errors are rough; absent otherwise and for runs that are not steady.
std::optional<int> few_samples(const dem::LocalData& data);

/// The results of a run in a few lines.
Summary describe(const dem::LocalData& data);

}  // namespace grainlaw
