#include "apps/campaign_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "apps/campaign_match.h"
#include "apps/campaign_run.h"
#include "apps/compare_runs.h"
#include "apps/imported_runs.h"
#include "apps/io/import.h"
#include "apps/io/profile_csv.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

std::string describe(const io::RunRecord& record) {
  const dem::LocalData& data = record.data;
  if (data.conditions.geometry != "simple_shear" || data.rows.empty()) return "";
  const dem::LocalRow& row = data.rows[data.rows.size() / 2];
  return fmt::format(" (I = {:.3g}, p* = {:.3g})", row.inertial_number.value, row.softness.value);
}

/// A run in the place the plan has for it.
void sort_in(CampaignData& all,
             dem::LocalData data,
             const io::PlannedRun& planned,
             std::string digest) {
  if (!data.window.steady) {
    all.warnings.push_back(fmt::format(
        "{} is not steady and is not fitted or scored: {}", data.name, data.window.reason));
  }
  const bool fitted = planned.fitted && data.window.steady;
  all.runs.push_back({std::move(data), planned.condition, fitted, std::move(digest)});
}

/// Folders as the local data in them.
std::vector<std::string> files_of(const std::vector<std::string>& from) {
  std::vector<std::string> files;
  for (const std::string& path : from) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(path)) {
      if (entry.path().extension() == ".h5") found.push_back(entry.path().string());
    }
    if (found.empty()) throw io::InputError(path + ": the folder holds no run (.h5)");
    std::ranges::sort(found);
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

}  // namespace

std::optional<io::SceneFile> started_from(const io::SceneFile& file,
                                          const continuum::RheologyTable& table,
                                          const fs::path& directory) {
  const auto steady = continuum::steady_chute(table, chute_case(dem::conditions(file.scene)));
  if (!continuum::flows(steady.answer.outcome)) return std::nullopt;
  const fs::path csv = fs::absolute(directory / (file.scene.name + ".csv"));
  io::safe_write(csv, io::profile_csv(steady.profile, steady.answer, file.units));
  const io::Override start{"start", "profile", io::start_value(csv)};
  return io::parse_scene(io::with_values(file.text, {start}), file.path);
}

std::vector<dem::LocalData> CampaignData::fitted() const {
  std::vector<dem::LocalData> data;
  for (const MeasuredRun& run : runs) {
    if (run.fitted) data.push_back(run.data);
  }
  return data;
}

std::vector<dem::LocalData> CampaignData::chutes() const {
  std::vector<dem::LocalData> data;
  for (const MeasuredRun& run : runs) {
    if (run.data.conditions.geometry == "chute") data.push_back(run.data);
  }
  std::ranges::stable_sort(
      data, {}, [](const dem::LocalData& run) { return run.conditions.inclination; });
  return data;
}

std::vector<io::PlannedRun> runs_with_starts(const io::Campaign& campaign,
                                             const fs::path& directory,
                                             std::vector<std::string>& warnings) {
  std::vector<io::PlannedRun> runs = io::planned_runs(campaign);
  if (campaign.start_table.empty()) return runs;
  const fs::path starts = directory / "starts";
  fs::create_directories(starts);
  for (io::PlannedRun& run : runs) {
    if (!std::holds_alternative<dem::Chute>(run.file.scene.geometry)) continue;
    const auto table = io::in_grain_units(io::read_table(campaign.start_table), run.file.units);
    if (auto started = started_from(run.file, table, starts)) {
      run.file = std::move(*started);
    } else {
      warnings.push_back(fmt::format("{} starts from rest: {} lets it rest",
                                     run.file.scene.name,
                                     campaign.start_table.filename().string()));
    }
  }
  return runs;
}

CampaignData measure(const io::Campaign& campaign,
                     const fs::path& directory,
                     int processes,
                     bool quiet) {
  CampaignData all;
  ProgressLine progress(quiet);
  const fs::path run_directory = directory / "runs";
  fs::create_directories(run_directory);
  const auto planned = runs_with_starts(campaign, directory, all.warnings);
  std::vector<io::SceneFile> scenes;
  for (const io::PlannedRun& run : planned) scenes.push_back(run.file);
  std::vector<CampaignRun> made = run_scenes(scenes, run_directory, processes, progress);
  for (std::size_t k = 0; k < made.size(); ++k) {
    CampaignRun& run = made[k];
    if (!run.data) {
      all.failed.push_back(fmt::format("{} failed: {}", run.name, run.failure));
      continue;
    }
    all.kept += run.kept ? 1 : 0;
    all.costs.push_back({"DEM " + run.name, run.data->summary.wall_seconds, run.cpu_seconds});
    sort_in(all, std::move(*run.data), planned[k], io::digest(data_path(run_directory, run.name)));
  }
  all.warnings.insert(all.warnings.end(), all.failed.begin(), all.failed.end());
  return all;
}

CampaignData gather(const io::Campaign& campaign, const std::vector<std::string>& from) {
  CampaignData all;
  const std::vector<io::PlannedRun> planned = io::planned_runs(campaign);
  std::set<std::string> seen;
  for (const std::string& file : files_of(from)) {
    io::RunRecord record = io::read_run(file);
    std::string digest = io::digest(record);
    if (!seen.insert(digest).second) {
      throw io::InputError(file + ": the same run is given twice; it would count twice in the fit");
    }
    const io::PlannedRun* run = planned_for(record, planned, !campaign.series.empty());
    if (run == nullptr) {
      throw io::InputError(fmt::format(
          "{}: its {} are not those of the campaign{}; compare it with `grainlaw compare` instead",
          file,
          campaign.shear_boxes.empty() ? "grains, base, mass or tilt" : "grains or conditions",
          describe(record)));
    }
    all.costs.push_back({"DEM " + record.data.name, record.data.summary.wall_seconds, 0.0});
    sort_in(all, record.data, *run, std::move(digest));
    all.runs.back().place = static_cast<std::size_t>(run - planned.data());
    if (!record.imported_from.empty()) all.imported.push_back(std::move(record));
  }
  std::ranges::stable_sort(all.runs, {}, &MeasuredRun::place);
  const std::vector<std::string> unsound = failed_checks(all.imported);
  all.warnings.insert(all.warnings.end(), unsound.begin(), unsound.end());
  return all;
}

}  // namespace grainlaw
