#include "apps/io/campaign_input.h"

#include <fmt/format.h>

#include <algorithm>

namespace grainlaw::io {
namespace {

std::vector<double> read_tilts(Section& section, std::string_view key, std::string_view meaning) {
  auto tilts = section.read<std::vector<double>>({key, meaning, {"degrees"}, chute_tilts});
  if (section.has(key) && tilts.empty()) {
    section.problem(key, fmt::format("'{}' is empty: give at least one tilt", key));
  }
  std::ranges::transform(tilts, tilts.begin(), radians);
  return tilts;
}

/// Tilts are the same when their runs would have the same name.
void refuse_duplicates(Section& section, const Campaign& campaign) {
  std::vector<std::string> names;
  const auto add = [&](const std::vector<double>& tilts, std::string_view key) {
    for (const double tilt : tilts) {
      const std::string name = run_name(tilt);
      if (std::ranges::count(names, name) > 0) {
        section.problem(key,
                        fmt::format("tilt {:.6g} degrees is there twice: a run cannot be used "
                                    "twice, nor be both fitted and predicted",
                                    degrees(tilt)));
      }
      names.push_back(name);
    }
  };
  add(campaign.calibrate_tilts, "calibrate");
  add(campaign.predict_tilts, "predict");
}

std::string read_keys(InputFile& in, Campaign& campaign) {
  Section top = in.top();
  campaign.title = top.read_or<std::string>(
      {"title", "of the report"}, in.path().stem().string(), "name of the file");
  auto scene = top.read<std::string>({"scene", "scene file, relative to this file"});
  campaign.start_table =
      top.find<std::string>({"start_table",
                             "rheology table, relative to this file: every run starts with the "
                             "velocity profile it predicts"},
                            "runs start from rest")
          .value_or("");
  Section tilts = in.section("tilts", "Tilts of the scene, each one run");
  campaign.calibrate_tilts = read_tilts(tilts, "calibrate", "runs the law is fitted to");
  campaign.predict_tilts = read_tilts(tilts, "predict", "runs that check the predictions");
  refuse_duplicates(tilts, campaign);
  return scene;
}

}  // namespace

Campaign read_campaign(const std::filesystem::path& path) {
  InputFile in = InputFile::open(path);
  Campaign campaign;
  const std::string scene = read_keys(in, campaign);
  in.finish();
  campaign.text = in.text();
  campaign.path = path;
  if (!campaign.start_table.empty())
    campaign.start_table = path.parent_path() / campaign.start_table;
  try {
    campaign.scene = read_scene(path.parent_path() / scene);
  } catch (const ReadError& error) {
    throw InputError(in.message("", "scene", error.what()));
  }
  const dem::Geometry& geometry = campaign.scene.scene.geometry;
  if (!std::holds_alternative<dem::Chute>(geometry)) {
    throw InputError(in.message("",
                                "scene",
                                fmt::format("a campaign tilts a chute, and this scene is a {}: run "
                                            "it with grainlaw dem",
                                            dem::kind(geometry))));
  }
  if (!std::get<dem::Chute>(geometry).tilts.empty()) {
    throw InputError(
        in.message("",
                   "scene",
                   "a run of a campaign has one tilt, and this scene changes it: leave out tilts"));
  }
  return campaign;
}

std::string run_name(double tilt) {
  return fmt::format("theta{:.6g}", degrees(tilt));
}

SceneFile scene_at(const Campaign& campaign, double tilt) {
  SceneFile file = campaign.scene;
  std::get<dem::Chute>(file.scene.geometry).inclination = tilt;
  file.scene.name = run_name(tilt);
  restate(file,
          {{"", "name", fmt::format("\"{}\"", file.scene.name)},
           {"geometry",
            "inclination",
            fmt::format("{}", exact_degrees(tilt).value_or(degrees(tilt)))}});
  return file;
}

std::string campaign_keys() {
  InputFile in = InputFile::listing();
  Campaign campaign;
  read_keys(in, campaign);
  return in.key_list();
}

}  // namespace grainlaw::io
