#include "apps/io/campaign_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/io/campaign_scenes.h"

namespace grainlaw::io {
namespace {

constexpr std::string_view boxes_name = "shear_boxes";
constexpr std::string_view series_name = "series";

/// What the keys say, and the scene files they name.
struct Keys {
  Campaign campaign;
  std::string scene;
  std::optional<std::string> calibrate_scene;
  std::vector<std::string> box_scenes;
  std::vector<Section> boxes;
  std::vector<Section> series;
  std::vector<std::vector<std::string>> series_scenes;
};

template <class T>
void refuse_empty(Section& section, std::string_view key, const std::vector<T>& values) {
  if (section.has(key) && values.empty()) {
    section.problem(key, fmt::format("'{}' is empty: give at least one value", key));
  }
}

template <class T>
void refuse_repeated(Section& section, std::string_view key, std::vector<T> values) {
  std::ranges::sort(values);
  const auto twice = std::ranges::adjacent_find(values);
  if (twice != values.end()) {
    section.problem(key, fmt::format("{} is there twice in '{}'", *twice, key));
  }
}

std::vector<double> read_tilts(Section& section,
                               std::string_view key,
                               std::string_view meaning,
                               std::string_view note) {
  const Key tilts{key, meaning, {"degrees"}, chute_tilts};
  auto values = section.find<std::vector<double>>(tilts, note).value_or(std::vector<double>{});
  refuse_empty(section, key, values);
  std::ranges::transform(values, values.begin(), radians);
  return values;
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

void read_tilt_keys(InputFile& in, bool with_boxes, bool with_series, Campaign& campaign) {
  const std::string_view meaning = "Tilts of the scene, each one run; needed without shear boxes";
  const bool optional = with_boxes || with_series;
  Section tilts = optional ? in.optional_section("tilts", meaning) : in.section("tilts", meaning);
  campaign.calibrate_tilts =
      read_tilts(tilts, "calibrate", "runs the law is fitted to", "required; not with shear boxes");
  campaign.predict_tilts =
      read_tilts(tilts, "predict", "runs that check the predictions", "required");
  if (!optional) tilts.report_missing({"calibrate", "runs the law is fitted to", {"degrees"}});
  if (!optional || tilts.given()) {
    tilts.report_missing({"predict", "runs that check the predictions", {"degrees"}});
  }
  if (with_boxes && tilts.has("calibrate")) {
    tilts.problem("calibrate",
                  "'calibrate' and [[shear_boxes]] exclude each other: one law is fitted to one "
                  "geometry, here to the boxes",
                  "give these tilts under 'predict': they then check the law across geometries");
  }
  refuse_duplicates(tilts, campaign);
}

/// A list of numbers that may be absent, without repetitions.
std::vector<double> read_list(Section& section, const Key& key, std::string_view note) {
  auto values = section.find<std::vector<double>>(key, note).value_or(std::vector<double>{});
  refuse_empty(section, key.name, values);
  refuse_repeated(section, key.name, values);
  return values;
}

ShearBoxes read_boxes(Section& section) {
  ShearBoxes boxes;
  const Key inertial{"inertial_number", "I, one run each with every p* and Bo", {}, positive};
  boxes.inertial_numbers = read_list(section, inertial, "required");
  section.report_missing(inertial);
  boxes.softness =
      read_list(section, {"softness", "p*: sets the pressure", {}, positive}, "that of the scene");
  boxes.bond_numbers = read_list(
      section,
      {"bond_number", "Bo: sets the strength of [contact.cohesion]; 0: without", {}, not_negative},
      "that of the scene");
  boxes.strain = section.find<double>({"strain",
                                       "to average over; the time limit is twice it, or 2 more, "
                                       "samples are 0.005 apart, frames 0.1",
                                       {},
                                       positive},
                                      "the times of the scene");
  return boxes;
}

void read_series_keys(InputFile& in, Keys& keys) {
  keys.series = in.sections(series_name,
                            "Chutes that differ in one property; instead of tilts and boxes. Xi of "
                            "their Bagnold laws is held against how long their contacts last");
  for (Section& section : keys.series) {
    ChuteSeries series;
    series.name = section.read<std::string>(
        {"name", "of the series: runs of one material, of which c0 is one value over its tilts"});
    auto scenes = section.read<std::vector<std::string>>(
        {"scenes",
         "chutes, relative to this file; their [lifetimes] are compared where they have them"});
    refuse_empty(section, "scenes", scenes);
    refuse_repeated(section, "scenes", scenes);
    keys.series_scenes.push_back(std::move(scenes));
    keys.campaign.series.push_back(std::move(series));
  }
}

Keys read_keys(InputFile& in) {
  Keys keys;
  Campaign& campaign = keys.campaign;
  Section top = in.top();
  campaign.title = top.read_or<std::string>(
      {"title", "of the report"}, in.path().stem().string(), "name of the file");
  const Key scene{"scene", "chute that is tilted, relative to this file"};
  keys.scene = top.find<std::string>(scene, "required with [tilts]").value_or("");
  const Key calibrate{"calibrate_scene",
                      "chute of the same grains and base for the tilts to calibrate, where that "
                      "is another than the one to predict, relative to this file"};
  keys.calibrate_scene = top.find<std::string>(calibrate, "scene");
  campaign.seeds =
      top.find<std::vector<std::int64_t>>(
             {"seeds",
              "every run once per seed; the scatter between them is reported beside the errors, "
              "which are scatter in time",
              {},
              not_negative},
             "the seed of the scene")
          .value_or(std::vector<std::int64_t>{});
  refuse_empty(top, "seeds", campaign.seeds);
  refuse_repeated(top, "seeds", campaign.seeds);
  campaign.start_table =
      top.find<std::string>({"start_table",
                             "rheology table, relative to this file: every chute starts with the "
                             "velocity profile it predicts"},
                            "runs start from rest")
          .value_or("");
  keys.boxes = in.sections(boxes_name,
                           "Boxes of simple shear the law is fitted to, as many of "
                           "these sections as needed");
  for (Section& section : keys.boxes) {
    keys.box_scenes.push_back(section.read<std::string>(
        {"scene", "a simple_shear at a pressure, relative to this file"}));
    campaign.shear_boxes.push_back(read_boxes(section));
  }
  read_series_keys(in, keys);
  const bool with_boxes = !keys.boxes.empty();
  read_tilt_keys(in, with_boxes, !keys.series.empty(), campaign);
  if (in.optional_section("tilts", "").given()) top.report_missing(scene);
  if (keys.calibrate_scene && campaign.calibrate_tilts.empty()) {
    top.problem("calibrate_scene", "there are no [tilts] to calibrate at");
  }
  if (top.has("scene") && with_boxes && campaign.predict_tilts.empty()) {
    top.problem("scene", "'scene' is a chute to tilt, and there are no [tilts] to predict");
  }
  return keys;
}

/// A scene that cannot be used is a problem of its key.
SceneFile scene_of(const InputFile& in,
                   std::string_view section,
                   const std::string& name,
                   std::string_view key = "scene") {
  try {
    return read_scene(in.path().parent_path() / name);
  } catch (const ReadError& error) {
    throw InputError(in.message(section, key, error.what()));
  }
}

void require_chute(const InputFile& in, const SceneFile& file, std::string_view key) {
  const dem::Geometry& geometry = file.scene.geometry;
  if (std::holds_alternative<dem::Chute>(geometry)) return;
  throw InputError(in.message("",
                              key,
                              fmt::format("a campaign tilts a chute, and this scene is a {}: run "
                                          "it with grainlaw dem",
                                          dem::kind(geometry))));
}

void require_one_tilt(const InputFile& in, const SceneFile& file, std::string_view key) {
  const auto* chute = std::get_if<dem::Chute>(&file.scene.geometry);
  if (chute == nullptr || chute->tilts.empty()) return;
  throw InputError(in.message(
      "", key, "a run of a campaign has one tilt, and this scene changes it: leave out tilts"));
}

void require_box(const InputFile& in, const std::string& section, const ShearBoxes& boxes) {
  const auto refuse = [&](std::string_view key, const std::string& text) {
    throw InputError(in.message(section, key, text));
  };
  const dem::Scene& scene = boxes.scene.scene;
  const auto* box = std::get_if<dem::SimpleShear>(&scene.geometry);
  if (box == nullptr) {
    refuse("scene",
           fmt::format("shear boxes are scenes of kind \"simple_shear\", and this is a {}",
                       dem::kind(scene.geometry)));
  } else if (!box->pressure || *box->pressure == 0.0) {
    refuse("scene", "I and p* are set by the shear rate and a pressure, which this scene lacks");
  }
  const bool wants_cohesion =
      std::ranges::any_of(boxes.bond_numbers, [](double bond) { return bond > 0.0; });
  if (wants_cohesion && std::holds_alternative<dem::Cohesionless>(scene.cohesion)) {
    refuse("bond_number", "bond numbers above 0 need a [contact.cohesion] in the scene");
  }
}

/// mu_p; 0 without friction.
double sliding_coefficient(const dem::Scene& scene) {
  return std::visit(
      [](const auto& law) {
        if constexpr (requires { law.coefficient; })
          return law.coefficient;
        else
          return 0.0;
      },
      scene.friction);
}

/// One law belongs to one kind of grains.
void require_same_grains(const InputFile& in,
                         const std::string& section,
                         std::string_view key,
                         const dem::Scene& first,
                         const dem::Scene& other,
                         std::string_view which) {
  if (sliding_coefficient(first) == sliding_coefficient(other) &&
      first.grains.size_ratio == other.grains.size_ratio) {
    return;
  }
  throw InputError(in.message(section,
                              key,
                              fmt::format("the grains are not those {} (contact friction, "
                                          "size_ratio): one law belongs to one kind of grains",
                                          which)));
}

void require_chute_of_series(const InputFile& in,
                             const std::string& section,
                             const SceneFile& file) {
  if (std::holds_alternative<dem::Chute>(file.scene.geometry)) return;
  throw InputError(
      in.message(section, "scenes", fmt::format("{}: a series takes chutes", file.path.string())));
}

void read_series_scenes(const InputFile& in, const Keys& keys, Campaign& campaign) {
  for (std::size_t k = 0; k < keys.series.size(); ++k) {
    const std::string section = keys.series[k].name();
    for (const std::string& name : keys.series_scenes[k]) {
      campaign.series[k].scenes.push_back(scene_of(in, section, name, "scenes"));
      require_chute_of_series(in, section, campaign.series[k].scenes.back());
    }
  }
}

void read_scenes(const InputFile& in, const Keys& keys, Campaign& campaign) {
  read_series_scenes(in, keys, campaign);
  if (!keys.scene.empty()) {
    campaign.scene = scene_of(in, "", keys.scene);
    require_chute(in, campaign.scene, "scene");
  }
  if (keys.calibrate_scene) {
    campaign.calibrate_scene = scene_of(in, "", *keys.calibrate_scene, "calibrate_scene");
    require_chute(in, *campaign.calibrate_scene, "calibrate_scene");
    require_same_grains(in,
                        "",
                        "calibrate_scene",
                        campaign.scene.scene,
                        campaign.calibrate_scene->scene,
                        "of the chute to predict");
  }
  std::vector<ShearBoxes> boxes = std::move(campaign.shear_boxes);
  campaign.shear_boxes.clear();
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const std::string section = keys.boxes[k].name();
    boxes[k].scene = scene_of(in, section, keys.box_scenes[k]);
    require_box(in, section, boxes[k]);
    campaign.shear_boxes.push_back(std::move(boxes[k]));
    require_same_grains(in,
                        section,
                        "scene",
                        campaign.shear_boxes.front().scene.scene,
                        campaign.shear_boxes.back().scene.scene,
                        "of the first boxes");
  }
}

}  // namespace

Campaign read_campaign(const std::filesystem::path& path) {
  InputFile in = InputFile::open(path);
  Keys keys = read_keys(in);
  in.finish();
  Campaign campaign = std::move(keys.campaign);
  campaign.text = in.text();
  campaign.path = path;
  if (!campaign.start_table.empty())
    campaign.start_table = path.parent_path() / campaign.start_table;
  const bool of_a_law = !campaign.shear_boxes.empty() || !campaign.calibrate_tilts.empty() ||
                        !campaign.predict_tilts.empty();
  if (!campaign.series.empty() && of_a_law) {
    throw InputError(in.message(keys.series.front().name(),
                                "",
                                "no law is fitted to [[series]]: give them a campaign of their "
                                "own"));
  }
  read_scenes(in, keys, campaign);
  try {
    planned_runs(campaign);
  } catch (const InputError& error) {
    throw InputError(in.message("", "", error.what()));
  }
  require_one_tilt(in, campaign.scene, "scene");
  if (campaign.calibrate_scene) require_one_tilt(in, *campaign.calibrate_scene, "calibrate_scene");
  return campaign;
}

std::string campaign_keys() {
  InputFile in = InputFile::listing();
  read_keys(in);
  return in.key_list();
}

}  // namespace grainlaw::io
