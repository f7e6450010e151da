#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/scene_input.h"
#include "apps/progress.h"
#include "dem/local_data.h"

namespace grainlaw {

/// One finished or failed DEM run of a campaign.
struct CampaignRun {
  std::string name;
  std::optional<dem::LocalData> data;  ///< absent: the run failed
  std::string failure;                 ///< why, when it failed
  double cpu_seconds = 0.0;
};

/// Runs the scenes in their order, `threads` at a time, one thread each; local data go to
/// DIR/NAME.h5, checkpoints beside them. A run whose physics fails is reported in its result and
/// the others go on; a disk or memory failure ends them all and is thrown. After an interruption
/// (signal, --max-wall, kill) runs that were finished are taken as they are, and the others go on
/// from their checkpoints.
std::vector<CampaignRun> run_scenes(const std::vector<io::SceneFile>& scenes,
                                    const std::filesystem::path& directory,
                                    int threads,
                                    ProgressLine& progress);

}  // namespace grainlaw
