#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/scene_input.h"
#include "apps/progress.h"
#include "dem/local_data.h"

namespace grainlaw {

/// One DEM run of a campaign: finished, failed, or stopped.
struct CampaignRun {
  std::string name;
  std::optional<dem::LocalData> data;  ///< absent: the run failed or was stopped
  std::string failure;                 ///< why there are no data
  bool kept = false;                   ///< it was finished before
  double cpu_seconds = 0.0;
};

/// Where the scene and the data of a run are.
std::filesystem::path scene_path(const std::filesystem::path& directory, const std::string& name);
std::filesystem::path data_path(const std::filesystem::path& directory, const std::string& name);

/// Writes the scene of every run to DIR/NAME.toml. Throws io::FileError.
void write_scenes(const std::vector<io::SceneFile>& scenes, const std::filesystem::path& directory);

/// Runs the scenes in their order, `processes` at a time, each in a process of its own with one
/// thread; scenes and local data go to DIR/NAME.toml and .h5, checkpoints beside them.
///
/// Runs that were finished before, by the same text of the scene and the same version, are kept;
/// others go on from their checkpoints. What another text made is moved to DIR/replaced. A run
/// that fails or crashes is moved to DIR/failed with the reason in NAME.txt, and the others go on;
/// a disk failure stops them all, with checkpoints where the disk allows, and is thrown as
/// io::FileError.
std::vector<CampaignRun> run_scenes(const std::vector<io::SceneFile>& scenes,
                                    const std::filesystem::path& directory,
                                    int processes,
                                    ProgressLine& progress);

}  // namespace grainlaw
