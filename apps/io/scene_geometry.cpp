#include "apps/io/scene_geometry.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace grainlaw::io {
namespace {

/// What the keys of every geometry are read with.
struct Reader {
  InputFile& in;
  const Units& units;
  const dem::Grains& grains;
  bool with_start;

  double length(Section& section, std::string_view name, std::string_view meaning) const {
    return section.read<double>({name, meaning, units[dimension::length], positive});
  }
  double period(Section& section,
                std::string_view name,
                std::string_view meaning,
                double otherwise) const {
    const Bounds bounds = diameters_or_more(dem::limits::least_period);
    return section.read_or<double>(
        {name, meaning, units[dimension::length], bounds}, otherwise, "d");
  }
  /// Refuses keys that make a packing.
  void not_used(Section& section, const std::vector<std::string_view>& keys) const {
    for (const std::string_view key : keys) {
      if (!with_start || !section.has(key)) continue;
      section.problem(
          key,
          fmt::format("'{}' is not used with [start]: the grains come from its file; leave it out",
                      key));
    }
  }
};

Bounds inside(const dem::limits::Interval& interval) {
  return from_to(interval.least, interval.most);
}

constexpr Bounds counts = from_to(1.0, dem::limits::grains);

int read_count(const Reader& read, Section& section, std::string_view meaning) {
  const Key key{"grains", meaning, {}, counts};
  const auto count = section.find<std::int64_t>(key, "required, unless there is a [start]");
  read.not_used(section, {"grains"});
  if (!count && !read.with_start) section.report_missing(key);
  return read.with_start ? 0 : static_cast<int>(count.value_or(1));
}

/// Exactly one of the number of grains and a nominal depth over an area [d^2].
int read_count_or_depth(const Reader& read, Section& section, double area) {
  const auto grains =
      section.find<std::int64_t>({"grains", "number of flowing grains", {}, counts});
  const auto depth = section.find<double>(
      {"depth",
       "nominal depth: gives 0.57 x depth x area of the base / mean volume of a grain",
       read.units[dimension::length],
       positive});
  read.not_used(section, {"grains", "depth"});
  if (read.with_start) return 0;
  section.exactly_one_of({"grains", "depth"});
  const double volume = std::numbers::pi / 6.0 * read.grains.mean_mass();  // m = d = 1
  const double number = grains ? static_cast<double>(*grains)
                               : depth.value_or(1.0) * area * dem::nominal_packing / volume;
  if (!(number <= dem::limits::grains)) {
    section.problem("depth", fmt::format("{:.3g} grains: at most {}", number, dem::limits::grains));
    return 0;
  }
  return static_cast<int>(std::lround(number));
}

double read_volume_fraction(Section& section, double otherwise, std::string_view meaning) {
  return section.read_or<double>(
      {"volume_fraction", meaning, {}, inside(dem::limits::volume_fraction)}, otherwise);
}

dem::BumpyBase read_slab(Section& section,
                         std::string_view thickness,
                         std::string_view fraction,
                         dem::BumpyBase base) {
  base.thickness = section.read_or<double>({thickness,
                                            "of the layer of centres of glued grains",
                                            {"grain diameter"},
                                            inside(dem::limits::base_thickness)},
                                           base.thickness);
  base.packing_fraction = section.read_or<double>({fraction,
                                                   "of the random packing it is cut from",
                                                   {},
                                                   inside(dem::limits::base_packing_fraction)},
                                                  base.packing_fraction);
  return base;
}

dem::LatticeBase read_lattice(Section& section) {
  dem::LatticeBase base;
  base.spacing = section.read_or<double>({"spacing",
                                          "\"lattice\": of neighbouring centres",
                                          {"grain diameter"},
                                          inside(dem::limits::lattice_spacing)},
                                         base.spacing);
  return base;
}

/// The base of a chute, or the walls of a plane shear, which cannot be flat.
dem::Base read_base(const Reader& read,
                    std::string_view name,
                    std::string_view meaning,
                    bool flat_allowed) {
  Section section = read.in.optional_section(name, meaning);
  std::vector<std::string> recipes{"bumpy", "lattice"};
  if (flat_allowed) recipes.emplace_back("flat");
  const std::string recipe =
      section.choice({"recipe",
                      "\"bumpy\": grains of a slab cut from a random packing, glued; \"lattice\": "
                      "a layer of them on a triangular lattice" +
                          std::string(flat_allowed ? "; \"flat\": a plane" : "")},
                     recipes,
                     "bumpy");
  dem::Base base;
  if (section.applies(recipe == "bumpy")) {
    base = read_slab(section, "thickness", "packing_fraction", {});
  }
  if (section.applies(recipe == "lattice")) base = read_lattice(section);
  if (flat_allowed && section.applies(recipe == "flat")) {
    base = dem::FlatBase{
        section.read_or<bool>({"frictional", "\"flat\": false for a smooth plane"}, true)};
  }
  if (recipe != "flat") {
    read.not_used(section, {"recipe", "thickness", "packing_fraction", "spacing"});
  }
  return base;
}

/// Tilts that follow the first: two lists of equal length.
std::vector<dem::TiltStep> read_tilts(const Reader& read, Section& section) {
  using Numbers = std::vector<double>;
  const auto times = section.find<Numbers>({"tilt_times",
                                            "the tilt changes at, ascending, since the start of "
                                            "the flow; a run is judged by what follows the last",
                                            read.units[dimension::time],
                                            positive},
                                           "the tilt stays");
  const auto tilts = section.find<Numbers>({"tilts", "tilt from then on", {"degrees"}, chute_tilts},
                                           "the tilt stays");
  const std::size_t count = times ? times->size() : 0;
  if (count != (tilts ? tilts->size() : 0)) {
    section.problem(tilts ? "tilts" : "tilt_times", "tilt_times and tilts must be equally long");
    return {};
  }
  std::vector<dem::TiltStep> steps;
  for (std::size_t k = 0; k < count; ++k) steps.push_back({(*times)[k], radians((*tilts)[k])});
  return steps;
}

dem::Chute read_chute(const Reader& read, Section section) {
  dem::Chute chute;
  chute.inclination = radians(section.read<double>({"inclination",
                                                    "tilt theta of the base; for a negative one "
                                                    "mirror the scene",
                                                    {"degrees"},
                                                    chute_tilts}));
  chute.tilts = read_tilts(read, section);
  chute.length = read.period(section, "length", "period along the flow", chute.length);
  chute.width = read.period(
      section, "width", "period across the flow, or distance of side walls", chute.width);
  chute.grains = read_count_or_depth(read, section, chute.length * chute.width);
  chute.base = read_base(read, "geometry.base", "The base of a chute", true);
  Section walls = read.in.optional_section(
      "geometry.sidewalls", "Flat side walls of a chute; without this section it is periodic");
  const bool frictional = walls.read_or<bool>({"frictional", "false for smooth walls"}, true);
  if (walls.given()) chute.sidewalls = dem::Sidewalls{frictional};
  return chute;
}

/// Exactly one of a stress to hold and the word for a volume that does not change.
std::optional<double> read_stress_or_fixed(const Reader& read,
                                           Section& section,
                                           const Key& stress,
                                           const Key& fixed) {
  const auto value = section.find<double>(
      {stress.name, stress.meaning, read.units[dimension::stress], stress.bounds});
  if (section.applies(section.has(fixed.name))) section.choice(fixed, {"fixed"});
  section.exactly_one_of({std::string(stress.name), std::string(fixed.name)});
  return value;
}

/// Either a volume fraction or all three sides.
void read_box(const Reader& read, Section& section, dem::SimpleShear& shear) {
  const std::array sides{std::pair{"length", &dem::Vec3::x},
                         std::pair{"height", &dem::Vec3::y},
                         std::pair{"width", &dem::Vec3::z}};
  const Bounds bounds = diameters_or_more(dem::limits::least_period);
  const bool sized = section.has("length") || section.has("height") || section.has("width");
  for (const auto& [name, component] : sides) {
    const Key key{name, "of the box at the start", read.units[dimension::length], bounds};
    const auto side = section.find<double>(key, "all three, or none: a cube by volume_fraction");
    if (!side && (sized || read.with_start)) section.report_missing(key);
    shear.size.*component = side.value_or(0.0);
  }
  shear.volume_fraction =
      read_volume_fraction(section, shear.volume_fraction, "of a cube at the start");
  if (sized && section.has("volume_fraction")) {
    section.problem("volume_fraction",
                    "volume_fraction and the sides of the box in [geometry] exclude each other");
  }
  read.not_used(section, {"volume_fraction"});
}

dem::SimpleShear read_simple_shear(const Reader& read, Section section) {
  dem::SimpleShear shear;
  shear.shear_rate =
      section.read<double>({"shear_rate", "d v_x / d y", read.units[dimension::rate], positive});
  shear.pressure = read_stress_or_fixed(
      read,
      section,
      {"pressure", "sigma_yy, held by the height of the box", {}, not_negative},
      {"volume", "the height stays as it is"});
  shear.grains = read_count(read, section, "number of grains");
  read_box(read, section, shear);
  return shear;
}

dem::PlaneShear read_plane_shear(const Reader& read, Section section) {
  dem::PlaneShear shear;
  shear.velocity = section.read<double>(
      {"velocity", "of the upper wall along x", read.units[dimension::velocity], positive});
  shear.load = read_stress_or_fixed(read,
                                    section,
                                    {"load", "normal stress on the upper wall", {}, positive},
                                    {"gap", "the upper wall keeps its height"});
  shear.gravity = section.read_or<double>(
      {"gravity", "towards the lower wall", read.units[dimension::acceleration], not_negative},
      shear.gravity);
  shear.length = read.period(section, "length", "period along the flow", shear.length);
  shear.width = read.period(section, "width", "period across the flow", shear.width);
  shear.grains = read_count(read, section, "number of grains between the walls");
  shear.volume_fraction = read_volume_fraction(
      section, shear.volume_fraction, "between the walls at the start; gives their distance");
  read.not_used(section, {"volume_fraction"});
  shear.wall = read_base(read, "geometry.wall", "The two walls of a plane shear", false);
  return shear;
}

dem::BodyForceBox read_body_force_box(const Reader& read, Section section) {
  dem::BodyForceBox box;
  box.amplitude = section.read<double>({"amplitude",
                                        "F of the force per mass F sin(2 pi y / height) along x",
                                        read.units[dimension::acceleration],
                                        positive});
  box.pressure = section.read<double>({"pressure",
                                       "sigma_yy, held by the height of the box",
                                       read.units[dimension::stress],
                                       positive});
  box.length = read.period(section, "length", "period along x, the flow", box.length);
  box.width = read.period(section, "width", "period along z", box.width);
  box.grains = read_count(read, section, "number of grains");
  box.volume_fraction =
      read_volume_fraction(section, box.volume_fraction, "at the start; gives the height");
  return box;
}

dem::SplitBottom read_split_bottom(const Reader& read, Section section) {
  dem::SplitBottom cell;
  cell.inner_radius = read.length(section, "inner_radius", "R_i of the cylinder at rest");
  cell.split_radius = read.length(section, "split_radius", "R_s, where the bottom is split");
  cell.outer_radius = read.length(section, "outer_radius", "R_o of the turning cylinder");
  cell.wedge = radians(section.read_or<double>(
      {"wedge",
       "angle of the section, 360 over a whole number",
       {"degrees"},
       {.lower = 0.0, .upper = 360.0 / dem::limits::least_wedges, .upper_allowed = true}},
      30.0));
  cell.rotation_rate = section.read<double>({"rotation_rate",
                                             "Omega of the outer part",
                                             {"rad/time", read.units.size(dimension::rate)},
                                             positive});
  cell.grains = read_count_or_depth(read, section, dem::floor_area(cell));
  const dem::BumpyBase base = read_slab(section,
                                        "base_thickness",
                                        "base_packing_fraction",
                                        {cell.base_thickness, cell.base_packing_fraction});
  cell.base_thickness = base.thickness;
  cell.base_packing_fraction = base.packing_fraction;
  read.not_used(section, {"base_thickness", "base_packing_fraction"});
  return cell;
}

}  // namespace

Flow read_flow(InputFile& in, const dem::Grains& grains, bool with_start) {
  Section geometry = in.section("geometry", "The flow");
  const std::string kind =
      geometry.choice({"kind", "of the flow, see below"},
                      {"chute", "simple_shear", "plane_shear", "body_force_box", "split_bottom"});
  Flow flow;
  const auto take = [&](std::string_view word, bool falls, std::string_view meaning, auto reader) {
    if (!geometry.applies(kind == word)) return;
    Section section = geometry.when("kind", word, meaning);
    flow.units = falls ? read_units(in, section) : read_units(in);
    flow.geometry = reader(Reader{in, flow.units, grains, with_start}, section);
  };
  take("chute", true, "Inclined layer with a free surface, periodic along and across", read_chute);
  take("simple_shear",
       false,
       "Homogeneous shear of a box with Lees-Edwards boundaries, without gravity",
       read_simple_shear);
  take("plane_shear",
       false,
       "Layer between two rough walls, the upper one moving",
       read_plane_shear);
  take("body_force_box",
       false,
       "Periodic box driven by a sinusoidal body force, without gravity",
       read_body_force_box);
  take("split_bottom",
       true,
       "Wedge of a ring cell whose bottom is split: outer cylinder and outer bottom turn",
       read_split_bottom);
  return flow;
}

}  // namespace grainlaw::io
