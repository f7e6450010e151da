#include "apps/io/flow_input.h"

namespace grainlaw::io {
namespace {

using namespace continuum;

double read_length(Section& section,
                   const Units& units,
                   std::string_view name,
                   std::string_view meaning) {
  return section.read<double>({name, meaning, units[dimension::length], positive});
}

double read_stress(Section& section,
                   const Units& units,
                   std::string_view name,
                   std::string_view meaning) {
  return section.read<double>({name, meaning, units[dimension::stress], positive});
}

WallDrive read_drive(Section& section, const Units& units, std::string_view wall) {
  const std::string speed = "of the " + std::string(wall) + " wall";
  const std::string stress = "shear stress on the " + std::string(wall) + " wall";
  WallDrive drive;
  drive.velocity = section.find<double>({"velocity", speed, units[dimension::velocity], positive});
  drive.stress = section.find<double>({"stress", stress, units[dimension::stress], positive});
  section.exactly_one_of({"velocity", "stress"});
  return drive;
}

Extent read_extent(Section& section, const Units& units, std::string_view what) {
  const std::string height = std::string(what);
  Extent extent;
  extent.height = section.find<double>({"height", height, units[dimension::length], positive});
  extent.mass_per_area = section.find<double>({"mass_per_area",
                                               "of the material, per unit area across the height",
                                               units[dimension::mass_per_area],
                                               positive});
  section.exactly_one_of({"height", "mass_per_area"});
  return extent;
}

PlaneShear read_plane_shear(Section section, const Units& units) {
  PlaneShear flow;
  flow.drive = read_drive(section, units, "upper");
  flow.extent = read_extent(section, units, "distance of the walls");
  flow.load = read_stress(section, units, "load", "normal stress on the upper wall");
  flow.gravity = section.read_or<double>(
      {"gravity", "towards the lower wall", units[dimension::acceleration], not_negative}, 0.0);
  return flow;
}

BodyForceBox read_body_force_box(Section section, const Units& units) {
  BodyForceBox flow;
  flow.extent = read_extent(section, units, "of the box, one period of the force");
  flow.amplitude = section.read<double>({"amplitude",
                                         "F of the force per mass F sin(2 pi y / height) along x",
                                         units[dimension::acceleration],
                                         positive});
  flow.pressure = read_stress(section, units, "pressure", "sigma_yy");
  return flow;
}

AnnularShear read_annular_shear(Section section, const Units& units) {
  AnnularShear flow;
  flow.drive = read_drive(section, units, "inner");
  flow.inner_radius = read_length(section, units, "inner_radius", "R_i of the turning cylinder");
  flow.outer_radius = read_length(section, units, "outer_radius", "R_o of the cylinder at rest");
  flow.pressure = read_stress(section, units, "pressure", "on the cylinders, uniform");
  if (section.has("inner_radius") && section.has("outer_radius") &&
      flow.outer_radius <= flow.inner_radius)
    section.problem("outer_radius", "outer_radius must exceed inner_radius");
  return flow;
}

SplitBottomCase read_cell(Section& section, const Units& units) {
  SplitBottomCase cell;
  cell.split_radius = read_length(section, units, "split_radius", "R_s, where the bottom is split");
  cell.depth = read_length(section, units, "depth", "H of the filling");
  cell.rotation_rate = section.read<double>({"rotation_rate",
                                             "Omega of the outer part",
                                             {"rad/time", units.size(dimension::rate)},
                                             positive});
  cell.gravity = 1.0;
  return cell;
}

continuum::RingFlowCase read_ring_cell(Section section, const Units& units) {
  continuum::RingFlowCase ring;
  ring.inner_radius = read_length(section, units, "inner_radius", "R_i of the cylinder at rest");
  ring.cell = read_cell(section, units);
  ring.outer_radius = read_length(section, units, "outer_radius", "R_o of the turning cylinder");
  const double split = ring.cell.split_radius;
  if (section.has("inner_radius") && section.has("split_radius") && ring.inner_radius >= split)
    section.problem("inner_radius", "inner_radius must be below split_radius");
  if (section.has("outer_radius") && section.has("split_radius") && ring.outer_radius <= split)
    section.problem("outer_radius", "outer_radius must exceed split_radius");
  return ring;
}

SplitBottomCase read_split_bottom(Section section, const Units& units) {
  SplitBottomCase cell = read_cell(section, units);
  cell.surface_width = section.find<double>({"surface_width",
                                             "W of the error function at the surface",
                                             units[dimension::length],
                                             positive},
                                            "d (H/d)^(2/3)");
  return cell;
}

SimpleShearCase read_simple_shear(Section section) {
  using Numbers = std::vector<double>;
  SimpleShearCase shear;
  shear.inertial_numbers = section.read<Numbers>({"inertial_number", "I", {}, not_negative});
  shear.softnesses = section.find<Numbers>({"softness", "p*", {}, not_negative}, "0: rigid grains")
                         .value_or(shear.softnesses);
  shear.bond_numbers =
      section.find<Numbers>({"bond_number", "Bo", {}, not_negative}, "0: no cohesion")
          .value_or(shear.bond_numbers);
  return shear;
}

std::optional<double> read_nonlocal(InputFile& in, bool band) {
  Section section = in.optional_section(
      "nonlocal", "Nonlocal granular fluidity of a band or ring cell; without it the local law");
  if (section.given() && !band)
    section.problem(
        "",
        "[nonlocal] belongs to a shear band or a ring cell; leave it out for this kind of flow");
  if (!section.given()) return std::nullopt;
  return section.read<double>(
      {"amplitude", "A of the cooperativity length; 0.48 for glass beads", {}, not_negative});
}

/// Flows that are no band in one dimension.
void read_others(InputFile& in, Section& geometry, const std::string& kind, CaseFile& file) {
  if (geometry.applies(kind == "split_bottom")) {
    Section section = geometry.when(
        "kind", "split_bottom", "Ring cell with a split bottom: geometry of its band");
    file.units = read_units(in, section);
    file.split_bottom = read_split_bottom(section, file.units);
  }
  if (geometry.applies(kind == "ring_cell")) {
    Section section = geometry.when(
        "kind", "ring_cell", "Ring cell with a split bottom: its rotation over radius and height");
    file.units = read_units(in, section);
    file.ring_cell = read_ring_cell(section, file.units);
  }
  if (geometry.applies(kind == "simple_shear")) {
    Section section = geometry.when(
        "kind", "simple_shear", "Homogeneous shear: the law itself, at every combination");
    file.units = read_units(in);
    file.simple_shear = read_simple_shear(section);
  }
}

}  // namespace

void read_flow(InputFile& in, Section& geometry, CaseFile& file) {
  const std::string kind = geometry.choice({"kind", "of the flow, see below"},
                                           {"plane_shear",
                                            "body_force_box",
                                            "annular_shear",
                                            "split_bottom",
                                            "ring_cell",
                                            "simple_shear"});
  ShearBandCase band;
  const auto take = [&](std::string_view word, std::string_view meaning, auto reader) {
    if (!geometry.applies(kind == word)) return;
    Section section = geometry.when("kind", word, meaning);
    file.units = read_units(in);
    band.flow = reader(section, file.units);
  };
  take("plane_shear", "Layer between two walls, the upper one moving", read_plane_shear);
  take("body_force_box", "Periodic box driven by a sinusoidal body force", read_body_force_box);
  take("annular_shear", "Between two cylinders, the inner one turning", read_annular_shear);
  read_others(in, geometry, kind, file);
  const bool is_band = !file.split_bottom && !file.ring_cell && !file.simple_shear;
  const std::optional<double> amplitude = read_nonlocal(in, is_band || file.ring_cell);
  band.nonlocal_amplitude = amplitude;
  if (file.ring_cell) file.ring_cell->nonlocal_amplitude = amplitude;
  if (is_band) file.band = band;
}

}  // namespace grainlaw::io
