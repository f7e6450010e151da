#pragma once

#include <filesystem>
#include <optional>

#include "apps/io/scene_input.h"
#include "dem/local_data.h"

namespace grainlaw {

/// What the run of a scene has in its file that ended before its averaging time was over, where
/// that is steady for at least `least` [time]. The file is written again, as if the scene had asked
/// for no more, and checkpoints are removed. Absent, and the files as they were: there is no file,
/// or it is not steady that long. Contact lifetimes stay those of the whole file. Throws
/// io::ReadError, io::FileError.
std::optional<dem::LocalData> measured_so_far(const io::SceneFile& scene,
                                              double least,
                                              const std::filesystem::path& path);

}  // namespace grainlaw
