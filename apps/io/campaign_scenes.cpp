#include "apps/io/campaign_scenes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "apps/io/checksum.h"
#include "apps/io/safe_write.h"

namespace grainlaw::io {
namespace {

std::string in_quotes(const std::string& text) {
  return fmt::format("\"{}\"", text);
}

/// A number in the units of a file, without the digits that conversion adds.
std::string number(double value, const Unit& unit = {}) {
  return fmt::format("{:.10g}", value * unit.size);
}

double normal_stiffness(const dem::Scene& scene) {
  return std::visit([](const auto& law) { return law.stiffness; }, scene.normal);
}

/// f_a, the largest attraction of two mean grains.
double attraction(const dem::Scene& scene) {
  return std::visit(
      [&](const auto& law) {
        if constexpr (std::decay_t<decltype(law)>::attracts)
          return law.largest_attraction(0.5 * scene.grains.diameter);
        else
          return 0.0;
      },
      scene.cohesion);
}

/// The key every attraction is proportional to.
struct Strength {
  std::string_view key;
  double value;
  Dimension dimension;
};
Strength strength(const dem::ReversibleAdhesion& law) {
  return {"largest_force", law.largest_force, dimension::force};
}
Strength strength(const dem::GaussianWell& law) {
  return {"strength", law.strength, dimension::energy};
}
Strength strength(const dem::LiquidBridge& law) {
  return {"surface_tension", law.surface_tension, dimension::tension};
}
Strength strength(const dem::Cohesionless&) {
  return {};
}

/// Files that the scene names relative to itself, as its text can name them from anywhere.
std::vector<Override> absolute_start(const SceneFile& file) {
  std::vector<Override> changes;
  InputFile in = InputFile::from_text(file.text, file.path);
  Section start = in.optional_section("start", "");
  for (const std::string_view key : {"grains", "profile"}) {
    const auto name = start.find<std::string>({key, ""});
    if (!name) continue;
    const auto path = std::filesystem::absolute(file.path.parent_path() / *name);
    changes.push_back({"start", key, start_value(path)});
  }
  return changes;
}

/// The file with these values in its text, read again. `run` is for messages.
SceneFile reread(const SceneFile& file, const std::string& text, const std::string& run) {
  try {
    return parse_scene(text, file.path);
  } catch (const InputError& error) {
    throw InputError(fmt::format("run {} cannot be made of its scene: {}", run, error.what()));
  }
}

[[noreturn]] void refuse_text(const SceneFile& file, const std::string& run) {
  throw InputError(
      fmt::format("run {} cannot be made of {}: write each section with a header of its own, "
                  "[geometry], and each key on a line of its own",
                  run,
                  file.path.string()));
}

/// Enough to average over the wanted strain. The start takes 1 of a box, counted in whole frames of
/// 0.1, and 8 frames are judged; of a later start at most half of all frames is cut. (See
/// dem::assess.)
double longest_strain(double wanted) {
  return std::max(2.0 * wanted, wanted + 2.0);
}

std::vector<Override> strain_times(double strain, double rate, const Units& units) {
  const Unit time = units[dimension::time];
  const auto at = [&](double of_strain) { return number(of_strain / rate, time); };
  return {{"measurement", "sample_interval", at(0.005)},
          {"measurement", "frame_interval", at(0.1)},
          {"measurement", "averaging_time", at(strain)},
          {"measurement", "time_limit", at(longest_strain(strain))}};
}

/// What the text of a box has to say.
std::vector<Override> box_changes(const ShearBoxes& boxes,
                                  const BoxState& state,
                                  const std::string& name) {
  const dem::Scene& scene = boxes.scene.scene;
  const Units& units = boxes.scene.units;
  const double d = scene.grains.diameter;
  const double pressure = state.softness * normal_stiffness(scene) / d;
  const double rate = state.inertial_number * std::sqrt(pressure / scene.grains.density()) / d;
  std::vector<Override> changes = absolute_start(boxes.scene);
  changes.push_back({"", "name", in_quotes(name)});
  changes.push_back({"geometry", "shear_rate", number(rate, units[dimension::rate])});
  changes.push_back({"geometry", "pressure", number(pressure, units[dimension::stress])});
  if (!boxes.bond_numbers.empty() && state.bond_number > 0.0) {
    const Strength old = std::visit([](const auto& law) { return strength(law); }, scene.cohesion);
    const double force = state.bond_number * pressure * d * d;
    const double value = old.value * force / attraction(scene);
    changes.push_back({"contact.cohesion", old.key, number(value, units[old.dimension])});
  }
  if (boxes.strain)
    std::ranges::copy(strain_times(*boxes.strain, rate, units), std::back_inserter(changes));
  return changes;
}

bool near(double a, double b) {
  return std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b));
}

bool same_state(const BoxState& a, const BoxState& b) {
  return near(a.inertial_number, b.inertial_number) && near(a.softness, b.softness) &&
         near(a.bond_number, b.bond_number);
}

SceneFile box_at(const ShearBoxes& boxes, const BoxState& state, const std::string& name) {
  const bool without = !boxes.bond_numbers.empty() && state.bond_number == 0.0;
  const std::string text =
      without ? without_section(boxes.scene.text, "contact.cohesion") : boxes.scene.text;
  SceneFile file = reread(boxes.scene, with_values(text, box_changes(boxes, state, name)), name);
  if (!same_state(box_state(file.scene), state) || file.scene.name != name) {
    refuse_text(boxes.scene, name);
  }
  return file;
}

/// Every combination; where the scene sets p* or Bo, that one.
std::vector<BoxState> states_of(const ShearBoxes& boxes) {
  const BoxState own = box_state(boxes.scene.scene);
  std::vector<double> softness = boxes.softness;
  if (softness.empty()) softness.push_back(own.softness);
  std::vector<BoxState> states;
  for (const double p : softness) {
    for (const double inertial : boxes.inertial_numbers) {
      const double own_bond = own.bond_number * own.softness / p;  // its force does not change
      if (boxes.bond_numbers.empty()) states.push_back({inertial, p, own_bond});
      for (const double bond : boxes.bond_numbers) states.push_back({inertial, p, bond});
    }
  }
  return states;
}

std::vector<PlannedRun> box_runs(const Campaign& campaign) {
  std::map<std::string, int> uses;
  for (const ShearBoxes& boxes : campaign.shear_boxes) {
    for (const BoxState& state : states_of(boxes)) ++uses[run_name(state)];
  }
  const bool unique =
      std::ranges::all_of(uses, [](const auto& entry) { return entry.second == 1; });
  std::vector<PlannedRun> runs;
  for (const ShearBoxes& boxes : campaign.shear_boxes) {
    const std::string prefix = unique ? "" : boxes.scene.path.stem().string() + "_";
    for (const BoxState& state : states_of(boxes)) {
      const std::string name = prefix + run_name(state);
      runs.push_back({box_at(boxes, state, name), name, true});
    }
  }
  return runs;
}

SceneFile tilted(const SceneFile& scene, double tilt) {
  SceneFile file = scene;
  std::get<dem::Chute>(file.scene.geometry).inclination = tilt;
  file.scene.name = run_name(tilt);
  restate(file,
          {{"", "name", in_quotes(file.scene.name)},
           {"geometry",
            "inclination",
            fmt::format("{}", exact_degrees(tilt).value_or(degrees(tilt)))}});
  return file;
}

PlannedRun chute_run(const SceneFile& scene, double tilt, bool fitted) {
  SceneFile file = tilted(scene, tilt);
  const std::string name = file.scene.name;
  const std::string text = with_values(file.text, absolute_start(scene));
  SceneFile again = reread(scene, text, name);
  const auto* chute = std::get_if<dem::Chute>(&again.scene.geometry);
  if (again.scene.name != name || chute == nullptr || chute->inclination != tilt) {
    refuse_text(scene, name);
  }
  return {std::move(again), name, fitted};
}

/// As it stands; one without a name of its own has that of its file.
PlannedRun series_run(const SceneFile& file) {
  const std::string name = file.scene.name;
  std::vector<Override> changes = absolute_start(file);
  changes.push_back({"", "name", in_quotes(name)});
  SceneFile again = reread(file, with_values(file.text, changes), name);
  if (again.scene.name != name) refuse_text(file, name);
  return {std::move(again), name, false};
}

PlannedRun with_seed(const PlannedRun& run, std::int64_t seed) {
  PlannedRun seeded = run;
  const std::string name = fmt::format("{}_s{}", run.condition, seed);
  const std::vector<Override> changes{{"", "name", in_quotes(name)},
                                      {"", "seed", std::to_string(seed)}};
  const std::string text = with_values(run.file.text, changes);
  seeded.file = reread(run.file, text, name);
  if (seeded.file.scene.name != name) refuse_text(run.file, name);
  return seeded;
}

void refuse_equal_names(const std::vector<PlannedRun>& runs) {
  std::set<std::string> names;
  for (const PlannedRun& run : runs) {
    if (names.insert(run.file.scene.name).second) continue;
    throw InputError(
        fmt::format("two runs of the campaign are named {}: conditions are the same "
                    "in their first six digits, or scene files in their names",
                    run.file.scene.name));
  }
}

}  // namespace

BoxState box_state(const dem::Scene& scene) {
  const auto& box = std::get<dem::SimpleShear>(scene.geometry);
  const double pressure = box.pressure.value();
  const double d = scene.grains.diameter;
  return {.inertial_number = box.shear_rate * d * std::sqrt(scene.grains.density() / pressure),
          .softness = pressure * d / normal_stiffness(scene),
          .bond_number = attraction(scene) / (pressure * d * d)};
}

std::string run_name(double tilt) {
  return fmt::format("theta{:.6g}", degrees(tilt));
}

std::string run_name(const BoxState& state) {
  return fmt::format(
      "I{:.6g}_p{:.6g}_Bo{:.6g}", state.inertial_number, state.softness, state.bond_number);
}

std::string start_value(const std::filesystem::path& path) {
  return fmt::format("{}  # checksum {:016x}", in_quotes(path.string()), checksum(read_file(path)));
}

SceneFile scene_at(const Campaign& campaign, double tilt) {
  return tilted(campaign.scene, tilt);
}

std::vector<PlannedRun> planned_runs(const Campaign& campaign) {
  std::vector<PlannedRun> runs = box_runs(campaign);
  for (const ChuteSeries& series : campaign.series) {
    for (const SceneFile& file : series.scenes) runs.push_back(series_run(file));
  }
  const SceneFile& calibrated =
      campaign.calibrate_scene ? *campaign.calibrate_scene : campaign.scene;
  for (const double tilt : campaign.calibrate_tilts) {
    runs.push_back(chute_run(calibrated, tilt, true));
  }
  for (const double tilt : campaign.predict_tilts) {
    runs.push_back(chute_run(campaign.scene, tilt, false));
  }
  if (!campaign.seeds.empty()) {
    std::vector<PlannedRun> seeded;
    for (const PlannedRun& run : runs) {
      for (const std::int64_t seed : campaign.seeds) seeded.push_back(with_seed(run, seed));
    }
    runs = std::move(seeded);
  }
  refuse_equal_names(runs);
  return runs;
}

}  // namespace grainlaw::io
