#include "apps/io/scene_input.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace grainlaw::io {
namespace {

constexpr double reduced_mass = 0.5;  // of two equal grains, in internal units

Bounds inside(const dem::limits::Interval& interval) {
  return from_to(interval.least, interval.most);
}

/// Exactly one of three ways to say how a contact dissipates.
double read_damping(Section& section, const Units& units, double stiffness) {
  const auto rate = section.find<double>({"damping_rate",
                                          "gamma_n, times the reduced mass (Brewster et al. 2008)",
                                          units[dimension::rate],
                                          not_negative});
  const auto dashpot = section.find<double>({"dashpot",
                                             "gamma_n, times the velocity (Shi et al. 2020)",
                                             units[dimension::dashpot],
                                             not_negative});
  const auto restitution = section.find<double>(
      {"restitution", "normal restitution of a pair", {}, {0.0, 1.0, false, true}});
  section.exactly_one_of({"damping_rate", "dashpot", "restitution"});
  if (dashpot) return *dashpot / reduced_mass;
  if (restitution) return dem::damping_for(*restitution, stiffness, reduced_mass);
  return rate.value_or(0.0);
}

dem::Hooke read_normal(InputFile& in, const Units& units) {
  Section section = in.section("contact.normal", "Normal force between two grains");
  section.choice({"law", "spring and dashpot, linear in overlap and velocity"}, {"hooke"});
  const double stiffness = read_stiffness(section, units);
  return {.stiffness = stiffness, .damping = read_damping(section, units, stiffness)};
}

std::variant<dem::Frictionless, dem::Sliding> read_friction(InputFile& in,
                                                            const Units& units,
                                                            double normal_stiffness) {
  Section section = in.optional_section(
      "contact.friction", "Tangential force; without this section grains are frictionless");
  if (!section.given()) return dem::Frictionless{};
  dem::Sliding law;
  section.choice({"law", "tangential spring, cut at the Coulomb limit"}, {"sliding"});
  law.coefficient = section.read<double>(
      {"coefficient", "mu_p, static and dynamic; for 0 leave the section out", {}, positive});
  const Key stiffness{"stiffness", "k_t", units[dimension::stiffness], positive};
  law.stiffness = section.find<double>(stiffness, "2/7 of the normal stiffness")
                      .value_or(2.0 / 7.0 * normal_stiffness);
  law.damping = section.read_or<double>(
      {"damping_rate", "gamma_t, times the reduced mass", units[dimension::rate], not_negative},
      0.0);
  return law;
}

dem::BumpyBase read_base(InputFile& in) {
  dem::BumpyBase base;
  Section section = in.optional_section("geometry.base", "The rough base of a chute");
  section.choice({"recipe", "\"bumpy\": grains of a slab cut from a random packing, glued"},
                 {"bumpy"},
                 "bumpy");
  base.thickness = section.read_or<double>(
      {"thickness", "of the slab", {"grain diameter"}, inside(dem::limits::base_thickness)},
      base.thickness);
  base.packing_fraction = section.read_or<double>({"packing_fraction",
                                                   "of the packing it is cut from",
                                                   {},
                                                   inside(dem::limits::base_packing_fraction)},
                                                  base.packing_fraction);
  return base;
}

/// Exactly one of the number of grains and a nominal depth.
int read_grains(Section& section, const Units& units, double area) {
  const auto grains = section.find<std::int64_t>(
      {"grains", "number of flowing grains", {}, from_to(1.0, dem::limits::grains)});
  const auto depth = section.find<double>(
      {"depth",
       "nominal depth, gives depth x length x width x 0.57 x 6/(pi d^3) grains",
       units[dimension::length],
       positive});
  section.exactly_one_of({"grains", "depth"});
  const double number =
      grains ? static_cast<double>(*grains)
             : depth.value_or(1.0) * area * dem::nominal_packing * 6.0 / std::numbers::pi;
  if (!(number <= dem::limits::grains)) {
    section.problem("depth", fmt::format("{:.3g} grains: at most {}", number, dem::limits::grains));
    return 0;
  }
  return static_cast<int>(std::lround(number));
}

dem::Chute read_chute(InputFile& in, Section& section, const Units& units) {
  dem::Chute chute;
  section.choice({"kind", "\"chute\": inclined layer, periodic along and across the flow"},
                 {"chute"});
  chute.inclination = radians(section.read<double>({"inclination",
                                                    "tilt theta of the base; for a negative one "
                                                    "mirror the scene",
                                                    {"degrees"},
                                                    chute_tilts}));
  const Bounds period = diameters_or_more(dem::limits::least_period);
  chute.length = section.read_or<double>(
      {"length", "period along the flow", units[dimension::length], period}, chute.length, "d");
  chute.width = section.read_or<double>(
      {"width", "period across the flow", units[dimension::length], period}, chute.width, "d");
  chute.grains = read_grains(section, units, chute.length * chute.width);
  chute.base = read_base(in);
  return chute;
}

dem::Measurement read_measurement(InputFile& in, const Units& units) {
  dem::Measurement m;
  Section section = in.optional_section("measurement", "What is averaged, and for how long");
  const Unit time = units[dimension::time];
  m.bin_width = section.read_or<double>({"bin_width",
                                         "height of a bin, at most a third of the nominal depth",
                                         units[dimension::length],
                                         diameters_or_more(dem::limits::least_bin_width)},
                                        m.bin_width,
                                        "d");
  m.sample_interval = section.read_or<double>(
      {"sample_interval", "between two samples", time, positive}, m.sample_interval, "sqrt(d/g)");
  m.frame_interval =
      section.read_or<double>({"frame_interval", "samples are summed over it", time, positive},
                              m.frame_interval,
                              "sqrt(d/g)");
  m.averaging_time = section.read_or<double>(
      {"averaging_time", "wanted steady time", time, positive}, m.averaging_time, "sqrt(d/g)");
  m.time_limit =
      section.read_or<double>({"time_limit", "the run ends here, steady or not", time, positive},
                              m.time_limit,
                              "sqrt(d/g)");
  return m;
}

void read_time(InputFile& in, const Units& units, dem::Scene& scene) {
  Section section = in.optional_section("time", "Time step");
  const Unit time = units[dimension::time];
  const Key step{"step", "time step", time, positive};
  scene.time_step =
      section.find<double>(step, "shortest contact time / 50").value_or(scene.time_step);
  scene.allow_unstable_step = section.read_or<bool>(
      {"allow_unstable_step", "accept a step above the shortest contact time / 15"}, false);
}

/// Every key of a scene file, in the order of the key list.
dem::Scene read_keys(InputFile& in, Units& units) {
  dem::Scene scene;
  Section geometry = in.section("geometry", "The flow");
  units = read_units(in, geometry);
  Section top = in.top();
  scene.name = top.read_or<std::string>({"name", "of the run, for messages and reports"},
                                        in.path().stem().string(),
                                        "name of the file");
  scene.seed = static_cast<std::uint64_t>(
      top.read_or<std::int64_t>({"seed", "of every random number", {}, not_negative}, 1));
  scene.max_overlap = top.read_or<double>({"max_overlap",
                                           "the run stops at a larger overlap",
                                           {"grain radius"},
                                           between(0.0, dem::limits::overlap)},
                                          scene.max_overlap);
  const dem::Hooke normal = read_normal(in, units);
  scene.normal = normal;
  scene.friction = read_friction(in, units, normal.stiffness);
  scene.geometry = read_chute(in, geometry, units);
  scene.measurement = read_measurement(in, units);
  read_time(in, units, scene);
  return scene;
}

/// What only the scene as a whole can tell; the message points at the key it is about.
void validate(const InputFile& in, const dem::Scene& scene, const Units& units) {
  const auto message = [&](const dem::SceneError& error) {
    const bool grain = units.name == "grain";
    const auto hint = grain ? "" : "numbers of this message in the set \"grain\": m, d, sqrt(d/g)";
    return in.message(error.section, error.key, error.what(), hint);
  };
  try {
    dem::validate(scene);
  } catch (const dem::StepRefused& error) {
    throw dem::StepRefused(message(error), error.section, error.key);
  } catch (const dem::SceneError& error) {
    throw InputError(message(error));
  }
}

SceneFile read(InputFile in, const SceneOptions& options) {
  SceneFile file;
  file.scene = read_keys(in, file.units);
  in.finish();
  file.text = in.text();
  file.path = in.path();
  const bool overridden = options.allow_unstable_step && !file.scene.allow_unstable_step;
  file.scene.allow_unstable_step |= options.allow_unstable_step;
  validate(in, file.scene, file.units);
  if (overridden) restate(file, {{"time", "allow_unstable_step", "true"}});
  return file;
}

/// Is the text the scene, as far as programs override it?
bool says(const std::string& text, const SceneFile& file) {
  try {
    const dem::Scene scene = parse_scene(text, file.path).scene;
    return scene.name == file.scene.name &&
           scene.allow_unstable_step == file.scene.allow_unstable_step &&
           scene.geometry.inclination == file.scene.geometry.inclination;
  } catch (const InputError&) {
    return false;
  } catch (const dem::SceneError&) {
    return false;
  }
}

}  // namespace

SceneFile read_scene(const std::filesystem::path& path, const SceneOptions& options) {
  return read(InputFile::open(path), options);
}

SceneFile parse_scene(const std::string& text,
                      const std::filesystem::path& path,
                      const SceneOptions& options) {
  return read(InputFile::from_text(text, path), options);
}

void restate(SceneFile& file, const std::vector<Override>& overrides) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";  // only good at the very beginning
  if (file.text.starts_with(byte_order_mark)) file.text.erase(0, byte_order_mark.size());
  std::string text = with_values(file.text, overrides);
  file.text = says(text, file) ? std::move(text) : with_comments(file.text, overrides);
}

std::string scene_keys() {
  InputFile in = InputFile::listing();
  Units units;
  read_keys(in, units);
  return in.key_list();
}

}  // namespace grainlaw::io
