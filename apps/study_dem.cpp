// DEM settings that are swept: time step, number of grains, size of the base.
#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "apps/study_kinds.h"
#include "apps/study_sweep.h"

namespace grainlaw::study {
namespace {

/// Slope of the straight line through the points.
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    sx += x[k];
    sy += y[k];
    sxx += x[k] * x[k];
    sxy += x[k] * y[k];
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/// The slope by which the energy residual falls with the number of steps.
std::optional<double> order_in_time(const std::vector<Point>& points,
                                    const std::vector<double>& steps) {
  std::vector<double> x, y;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (!(points[k].error > 0.0)) continue;
    x.push_back(std::log(steps[k]));
    y.push_back(std::log(points[k].error));
  }
  if (x.size() < 2) return std::nullopt;
  return -slope(x, y);
}

/// Whether the scene states the number of grains; if not, a depth, which holds for every base.
bool counts_grains(const io::SceneFile& scene) {
  io::InputFile file = io::InputFile::from_text(scene.text, scene.path);
  return file.section("geometry", "").has("grains");
}

/// The side lengths of a chute on a larger base of the same shape, and its grains.
std::vector<io::Override> on_base(const io::SceneFile& scene, double side) {
  const auto& chute = std::get<dem::Chute>(scene.scene.geometry);
  const double scale = side / chute.length;
  const double unit = scene.units.size(io::dimension::length);
  std::vector<io::Override> overrides = {
      {"geometry", "length", fmt::format("{}", side * unit)},
      {"geometry", "width", fmt::format("{}", scale * chute.width * unit)}};
  if (counts_grains(scene)) {
    overrides.push_back(
        {"geometry", "grains", fmt::format("{}", std::lround(chute.grains * scale * scale))});
  }
  return overrides;
}

/// One setting with a run for each seed.
Setting with_seeds(const io::SceneFile& scene,
                   const std::string& label,
                   const std::string& name,
                   const std::vector<io::Override>& overrides,
                   const std::vector<double>& seeds) {
  Setting setting{.label = label, .scenes = {}};
  const auto make = [&](const std::string& run, std::optional<double> seed) {
    std::vector<io::Override> all = overrides;
    const std::string quoted = fmt::format("\"{}\"", run);
    const std::string number = fmt::format("{:.0f}", seed.value_or(0.0));
    all.push_back({"", "name", quoted});
    if (seed) all.push_back({"", "seed", number});
    setting.scenes.push_back(changed(scene, all));
  };
  if (seeds.empty()) make(name, std::nullopt);
  for (const double seed : seeds) make(fmt::format("{}_seed{:.0f}", name, seed), seed);
  return setting;
}

template <class Geometry>
io::SceneFile read_geometry(const std::filesystem::path& path, const char* what) {
  io::SceneFile scene = io::read_scene(path);
  if (!std::holds_alternative<Geometry>(scene.scene.geometry)) {
    throw io::InputError(fmt::format(
        "{}: a {}; this study takes a {}", path.string(), dem::kind(scene.scene.geometry), what));
  }
  return scene;
}

std::vector<Setting> settings_of(const io::TimeStepStudy& study) {
  const io::SceneFile scene = io::read_scene(study.scene);
  const dem::Geometry& geometry = scene.scene.geometry;
  if (!std::holds_alternative<dem::Chute>(geometry) &&
      !std::holds_alternative<dem::SimpleShear>(geometry)) {
    throw io::InputError(fmt::format("{}: a {}; this study takes a chute or a simple shear",
                                     study.scene.string(),
                                     dem::kind(geometry)));
  }
  const double shortest =
      dem::shortest_contact_time(scene.scene) * scene.units.size(io::dimension::time);
  std::vector<Setting> settings;
  for (const double n : study.steps_per_contact) {
    Setting setting{.label = fmt::format("t/{:g}", n), .scenes = {}};
    // A hair below, lest rounding refuses the limit itself.
    const std::string step = fmt::format("{}", shortest / n * (1.0 - 1e-12));
    const std::string name = fmt::format("\"step{:g}\"", n);
    try {
      setting.scenes.push_back(
          changed(scene, {{"", "name", name}, {"time", "step", step}}, study.allow_unstable_step));
    } catch (const dem::StepRefused&) {
      setting.failure = fmt::format("time step refused: above t/{:g}, the limit of stability",
                                    dem::limits::least_steps_per_contact);
    }
    settings.push_back(setting);
  }
  return settings;
}

std::vector<Setting> settings_of(const io::GrainsStudy& study) {
  const auto scene =
      read_geometry<dem::SimpleShear>(study.scene, "simple shear (for a chute: kind = \"base\")");
  if (std::get<dem::SimpleShear>(scene.scene.geometry).size.x > 0.0) {
    throw io::InputError(study.scene.string() +
                         ": the sides of its box are given; this study needs volume_fraction");
  }
  std::vector<Setting> settings;
  for (const double n : study.grains) {
    const std::string count = fmt::format("{:.0f}", n);
    settings.push_back(with_seeds(
        scene, "N = " + count, "grains" + count, {{"geometry", "grains", count}}, study.seeds));
  }
  return settings;
}

std::vector<Setting> settings_of(const io::BaseStudy& study) {
  const auto scene = read_geometry<dem::Chute>(study.scene, "chute");
  std::vector<Setting> settings;
  for (const double side : study.sides) {
    const std::string length = fmt::format("{:g}", side);
    settings.push_back(
        with_seeds(scene, length + " d", "side" + length, on_base(scene, side), study.seeds));
  }
  return settings;
}

Plan plan_of(const std::vector<Setting>& settings) {
  Plan plan;
  for (const Setting& setting : settings) {
    plan.scenes.insert(plan.scenes.end(), setting.scenes.begin(), setting.scenes.end());
    if (!setting.failure.empty()) plan.other.push_back(setting.label + ": " + setting.failure);
  }
  return plan;
}

}  // namespace

Plan plan(const io::TimeStepStudy& study) {
  return plan_of(settings_of(study));
}

Plan plan(const io::GrainsStudy& study) {
  return plan_of(settings_of(study));
}

Plan plan(const io::BaseStudy& study) {
  return plan_of(settings_of(study));
}

Result run(const io::TimeStepStudy& study, const io::StudyFile& file, const Context& context) {
  Result result = compare_with_finest(settings_of(study), file, context);
  if (const auto order = order_in_time(result.points, study.steps_per_contact)) {
    result.remarks.push_back(
        fmt::format("The energy residual falls with the power {:.2g} of the time step.", *order));
  }
  result.remarks.emplace_back("t is the shortest contact time of the grains in the scene.");
  return result;
}

Result run(const io::GrainsStudy& study, const io::StudyFile& file, const Context& context) {
  return compare_with_finest(settings_of(study), file, context);
}

Result run(const io::BaseStudy& study, const io::StudyFile& file, const Context& context) {
  return compare_with_finest(settings_of(study), file, context);
}

}  // namespace grainlaw::study
