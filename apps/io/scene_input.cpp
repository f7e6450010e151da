#include "apps/io/scene_input.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/io/scene_laws.h"
#include "apps/io/scene_lifetimes.h"
#include "apps/io/start_csv.h"
#include "apps/io/text_table.h"

namespace grainlaw::io {
namespace {

/// By which the default times of a measurement are told: about 0.1 of strain where the scene says
/// how fast it shears.
double time_scale(const dem::Chute&) {
  return 1.0;
}
double time_scale(const dem::SplitBottom&) {
  return 1.0;
}
double time_scale(const dem::SimpleShear& shear) {
  return 0.1 / shear.shear_rate;
}
double time_scale(const dem::PlaneShear& shear) {
  return 1.0 / shear.velocity;
}
double time_scale(const dem::BodyForceBox& box) {
  return std::sqrt(dem::Grains{}.density() / box.pressure);
}

void read_kernel(Section& section, const Units& units, dem::Kernel& kernel) {
  const std::string shape = section.choice(
      {"kernel",
       "that fields are smoothed with along z, in a box y (a homogeneous one has none): \"lucy\" "
       "reaches 2 widths, \"gaussian\" 3"},
      {"lucy", "gaussian"},
      "lucy");
  kernel.shape = shape == "gaussian" ? dem::KernelShape::gaussian : dem::KernelShape::lucy;
  const dem::limits::Interval& allowed = dem::limits::kernel_width;
  kernel.width = section.read_or<double>(
      {"width",
       "of the kernel; the standard deviation of a Gaussian, 1.62 times that of Lucy's",
       units[dimension::length],
       {.lower = allowed.least,
        .upper = allowed.most,
        .lower_allowed = true,
        .upper_allowed = true,
        .unit = "d"}},
      kernel.width,
      "d");
}

dem::Measurement read_measurement(InputFile& in, const Units& units, const dem::Geometry& flow) {
  dem::Measurement m;
  Section section = in.optional_section(
      "measurement",
      "What is averaged, and for how long. T is sqrt(d/g); 0.1/shear_rate in a simple shear, "
      "d/velocity in a plane shear, d sqrt(rho_p/pressure) in a box driven by a body force");
  m.bin_width = section.read_or<double>({"bin_width",
                                         "height of a row of fields, at most a third of the "
                                         "nominal depth, distance of walls or height",
                                         units[dimension::length],
                                         diameters_or_more(dem::limits::least_bin_width)},
                                        m.bin_width,
                                        "d");
  read_kernel(section, units, m.kernel);
  const double scale = std::visit([](const auto& shape) { return time_scale(shape); }, flow);
  const double unit = std::isfinite(scale) ? scale : 1.0;  // a bad number has been reported
  const auto read = [&](double& value, std::string_view name, std::string_view meaning) {
    const Key key{name, meaning, units[dimension::time], positive};
    value = section.find<double>(key, fmt::format("{} T", value)).value_or(value * unit);
  };
  read(m.sample_interval, "sample_interval", "between two samples");
  read(m.frame_interval, "frame_interval", "samples are summed over it");
  read(m.averaging_time, "averaging_time", "wanted steady time");
  read(m.time_limit, "time_limit", "the run ends here, steady or not");
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

void read_top(InputFile& in, dem::Scene& scene) {
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
}

void read_sizes(InputFile& in, dem::Grains& grains) {
  Section section =
      in.optional_section("grains", "The grains: what the set of units does not fix, and sizes");
  const dem::limits::Interval& allowed = dem::limits::size_ratio;
  grains.size_ratio = section.read_or<double>(
      {"size_ratio",
       "largest diameter over smallest, between which they are spread uniformly by number",
       {},
       from_to(allowed.least, allowed.most)},
      grains.size_ratio);
}

/// The files of a given start, one of them; both empty: none.
struct StartFiles {
  std::string grains;
  std::string profile;
};

StartFiles read_start_files(InputFile& in) {
  Section section = in.optional_section("start", "What to start from instead of rest");
  const Key grains{
      "grains",
      "CSV file, relative to this one: x,y,z, and as needed vx,vy,vz,wx,wy,wz,diameter,"
      "frozen; no packing is made and none of its keys allowed"};
  const Key profile{
      "profile",
      "CSV file of velocities, relative to this one, as grainlaw predict writes it in "
      "the units of this scene: the settled grains of a chute start with them"};
  StartFiles files{section.find<std::string>(grains).value_or(""),
                   section.find<std::string>(profile).value_or("")};
  section.exactly_one_of({"grains", "profile"});
  return files;
}

/// What a scene file says, and the file it points to.
struct Keys {
  dem::Scene scene;
  Units units;
  StartFiles start;
};

/// Every key of a scene file, in the order of the key list.
Keys read_keys(InputFile& in) {
  Keys keys;
  read_top(in, keys.scene);
  read_sizes(in, keys.scene.grains);
  keys.start = read_start_files(in);
  const Flow flow = read_flow(in, keys.scene.grains, !keys.start.grains.empty());
  keys.scene.geometry = flow.geometry;
  keys.units = flow.units;
  read_laws(in, keys.units, keys.scene);
  keys.scene.measurement = read_measurement(in, keys.units, keys.scene.geometry);
  keys.scene.lifetimes = read_lifetime_keys(in, keys.units);
  read_time(in, keys.units, keys.scene);
  return keys;
}

std::vector<dem::StartVelocity> read_profile(const std::filesystem::path& path,
                                             const Units& units) {
  const TextTable table = read_csv(path);
  const auto column = [&](std::string_view name, const Dimension& dimension) {
    return table.column(fmt::format("{} [{}]", name, units.symbol(dimension)),
                        "a start profile in the units of the scene");
  };
  const std::size_t z = column("z", dimension::length);
  const std::size_t velocity = column("velocity", dimension::velocity);
  std::vector<dem::StartVelocity> profile;
  for (const TableBlock& block : table.blocks) {
    for (const TableRow& row : block.rows) {
      profile.push_back({table.number(row, z) / units.size(dimension::length),
                         table.number(row, velocity) / units.size(dimension::velocity)});
    }
  }
  return profile;
}

/// What the start files hold; a file that cannot be read is a problem of its key.
void add_start(const InputFile& in, const Keys& keys, dem::Scene& scene) {
  const auto path = [&](const std::string& name) { return in.path().parent_path() / name; };
  const bool grains = !keys.start.grains.empty();
  try {
    if (grains) scene.start = read_start(path(keys.start.grains), keys.units);
    if (!keys.start.profile.empty()) {
      scene.start_profile = read_profile(path(keys.start.profile), keys.units);
    }
  } catch (const ReadError& error) {
    throw InputError(in.message("start", grains ? "grains" : "profile", error.what()));
  }
  if (grains) std::visit([&](auto& shape) { shape.grains = dem::grains(scene); }, scene.geometry);
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
  Keys keys = read_keys(in);
  in.finish();
  file.scene = std::move(keys.scene);
  file.units = keys.units;
  add_start(in, keys, file.scene);
  file.text = in.text();
  file.path = in.path();
  const bool overridden = options.allow_unstable_step && !file.scene.allow_unstable_step;
  file.scene.allow_unstable_step |= options.allow_unstable_step;
  validate(in, file.scene, file.units);
  if (overridden) restate(file, {{"time", "allow_unstable_step", "true"}});
  return file;
}

std::optional<double> inclination(const dem::Scene& scene) {
  const auto* chute = std::get_if<dem::Chute>(&scene.geometry);
  return chute != nullptr ? std::optional(chute->inclination) : std::nullopt;
}

/// Is the text the scene, as far as programs override it?
bool says(const std::string& text, const SceneFile& file) {
  try {
    const dem::Scene scene = parse_scene(text, file.path).scene;
    return scene.name == file.scene.name &&
           scene.allow_unstable_step == file.scene.allow_unstable_step &&
           inclination(scene) == inclination(file.scene) &&
           scene.start_profile.size() == file.scene.start_profile.size();
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
  read_keys(in);
  return in.key_list();
}

}  // namespace grainlaw::io
