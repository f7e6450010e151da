#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/io/campaign_scenes.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/report/report.h"

namespace grainlaw {

/// One finished run of a campaign.
struct MeasuredRun {
  dem::LocalData data;
  std::string condition;  ///< the same for runs that differ in their seed only
  bool fitted = false;    ///< the law is fitted to it; a chute that is not steady never is
  std::string digest;     ///< of its file
  std::size_t place = 0;  ///< in the plan: the order of files does not matter to a fit
};

/// What the runs of a campaign gave.
struct CampaignData {
  std::vector<MeasuredRun> runs;
  int kept = 0;                     ///< of them, finished before
  std::vector<std::string> failed;  ///< runs that gave nothing, with the reason
  std::vector<io::RunRecord> imported;
  std::vector<report::StageCost> costs;
  std::vector<std::string> warnings;

  std::vector<dem::LocalData> fitted() const;
  std::vector<dem::LocalData> chutes() const;  ///< fitted or not, by tilt
};

/// The runs of a campaign; with a start table, the chutes start with the profiles it predicts,
/// which are written to DIR/starts. A chute that the table lets come to rest starts from rest,
/// which is said in the warnings.
std::vector<io::PlannedRun> runs_with_starts(const io::Campaign& campaign,
                                             const std::filesystem::path& directory,
                                             std::vector<std::string>& warnings);

/// The chute with the velocity profile that the law predicts for it as its start, written to
/// DIR/NAME.csv; absent where the law lets it rest. Throws io::FileError.
std::optional<io::SceneFile> started_from(const io::SceneFile& file,
                                          const continuum::RheologyTable& table,
                                          const std::filesystem::path& directory);

/// Makes the runs of a campaign in DIR/runs, `processes` at a time; see run_scenes. After a stop
/// (signal, --max-wall) the data are not complete.
CampaignData measure(const io::Campaign& campaign,
                     const std::filesystem::path& directory,
                     int processes,
                     bool quiet);

/// Takes finished runs and imports (.toml); of a folder, all its .h5 files. Throws io::InputError
/// for a run that is given twice or was not made under conditions of the campaign.
CampaignData gather(const io::Campaign& campaign, const std::vector<std::string>& from);

}  // namespace grainlaw
