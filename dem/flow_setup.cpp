#include "dem/flow_setup.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grainlaw::dem {
namespace {

constexpr double dense_fraction = 0.55;  // of a flowing layer, for estimates only

double depth(const Grains& grains, const Chute& chute) {
  return mass_per_area(grains, chute) / (dense_fraction * grains.density());
}

double stiffness(const Scene& scene) {
  return std::visit([](const auto& law) { return law.stiffness; }, scene.normal);
}

/// A piston whose swings against the stiffness of the packing take about thirty contact times, and
/// whose damping is critical where only the pressure resists (a dilute, rapid flow).
BoxDrive box_drive(const Scene& scene, double shear_rate, std::optional<double> pressure) {
  constexpr double swing = 30.0;             // [contact times]
  constexpr double packing_stiffness = 0.5;  // bulk modulus of a dense packing [k_n / d]
  const double contact = std::numbers::pi * std::sqrt(0.5 * scene.grains.mass / stiffness(scene));
  const double frequency = 2.0 * std::numbers::pi / (swing * contact);
  const double modulus = packing_stiffness * stiffness(scene) / scene.grains.diameter;
  BoxDrive drive;
  drive.shear_rate = shear_rate;
  drive.pressure = pressure;
  drive.gain = frequency * frequency / modulus;
  drive.damping = 2.0 * std::sqrt(drive.gain * pressure.value_or(0.0)) + shear_rate;
  return drive;
}

double mover_mass(const InitialState& initial, const Grains& grains) {
  double mass = 0.0;
  for (const InitialGrain& grain : initial.grains) {
    if (grain.body == Body::mover) mass += grains.mass_of(grain.diameter);
  }
  return mass;
}

double lowest_grain(const InitialState& initial) {
  double lowest = INFINITY;
  for (const InitialGrain& grain : initial.grains) lowest = std::min(lowest, grain.position.z);
  return lowest;
}

/// Small grains find their way into the gaps of a layer of unequal glued grains, and under it; at a
/// split they would be crushed there. A smooth floor one mean diameter below the tops (z = 0)
/// leaves the bumps and closes the gaps. Equal grains need none; one that gets below the layer is
/// lost.
void lay_floor(const Scene& scene, const InitialState& initial, SimulationSetup& setup) {
  setup.lowest.z = lowest_grain(initial);
  if (scene.grains.size_ratio == 1.0) return;
  setup.lowest.z = -scene.grains.diameter;
  setup.walls.push_back({Plane{{0.0, 0.0, setup.lowest.z}, {0.0, 0.0, 1.0}}, false});
}

void add_geometry(const Chute& chute,
                  const Scene& scene,
                  const InitialState& initial,
                  SimulationSetup& setup) {
  setup.dynamics.field = Uniform{gravity(chute.gravity, chute.inclination)};
  if (const auto* flat = std::get_if<FlatBase>(&chute.base)) {
    setup.walls.push_back({Plane{{}, {0.0, 0.0, 1.0}}, flat->frictional});
    setup.lowest.z = 0.0;
  } else {
    lay_floor(scene, initial, setup);
  }
  if (!chute.sidewalls) return;
  const bool frictional = chute.sidewalls->frictional;
  setup.walls.push_back({Plane{{}, {0.0, 1.0, 0.0}}, frictional});
  setup.walls.push_back({Plane{{0.0, chute.width, 0.0}, {0.0, -1.0, 0.0}}, frictional});
  setup.lowest.y = 0.0;
  setup.highest.y = chute.width;
}

void add_geometry(const SimpleShear& box,
                  const Scene& scene,
                  const InitialState& initial,
                  SimulationSetup& setup) {
  setup.drive = box_drive(scene, box.shear_rate, box.pressure);
  setup.dynamics.field = Affine{box.shear_rate, 0.0, 0.0, 0.5 * initial.box.period.y};
}

void add_geometry(const PlaneShear& shear,
                  const Scene& scene,
                  const InitialState& initial,
                  SimulationSetup& setup) {
  setup.dynamics.field = Uniform{{0.0, 0.0, -shear.gravity}};
  WallDrive drive;
  drive.velocity = shear.velocity;
  drive.mass = mover_mass(initial, scene.grains);
  if (shear.load) {
    drive.load = *shear.load * shear.length * shear.width;
    // Comes to rest in about the time the load pushes a grain through its own size.
    drive.damping =
        drive.mass * std::sqrt(*shear.load / scene.grains.density()) / scene.grains.diameter;
  }
  setup.drive = drive;
  setup.lowest.z = lowest_grain(initial);
}

void add_geometry(const BodyForceBox& box,
                  const Scene& scene,
                  const InitialState& initial,
                  SimulationSetup& setup) {
  setup.drive = box_drive(scene, 0.0, box.pressure);
  const double height = initial.box.period.y;
  Sine sine;
  sine.amplitude = box.amplitude;
  sine.wave_number = 2.0 * std::numbers::pi / height;
  sine.middle = 0.5 * height;
  setup.dynamics.field = sine;
}

void add_geometry(const SplitBottom& cell,
                  const Scene& scene,
                  const InitialState& initial,
                  SimulationSetup& setup) {
  setup.dynamics.field = Uniform{{0.0, 0.0, -cell.gravity}};
  setup.drive = RotationDrive{cell.rotation_rate};
  lay_floor(scene, initial, setup);
  setup.walls.push_back({Cylinder{cell.inner_radius, false, 0.0}});
  setup.walls.push_back({Cylinder{cell.outer_radius, true, cell.rotation_rate}});
}

Bins layer_bins(const Scene& scene, double below, double above, double area) {
  const double width = scene.measurement.bin_width;
  const double rows_below = std::ceil(below / width);
  const std::size_t fine = bins_per_row(scene.measurement);
  return {.axis = ProfileAxis::z,
          .begin = -rows_below * width,
          .width = width / static_cast<double>(fine),
          .area = area,
          .count = fine * static_cast<std::size_t>(rows_below + std::ceil(above / width))};
}

double base_thickness(const Base& base) {
  const auto* bumpy = std::get_if<BumpyBase>(&base);
  return bumpy ? bumpy->thickness : 1.0;
}

Bins bins_of(const Chute& chute, const Scene& scene, const Box&) {
  const double d = scene.grains.diameter;
  return layer_bins(scene,
                    (base_thickness(chute.base) + 1.0) * d,
                    1.4 * depth(scene.grains, chute) + 6.0 * d,
                    chute.length * chute.width);
}

Bins bins_of(const PlaneShear& shear, const Scene& scene, const Box&) {
  const double d = scene.grains.diameter;
  const double area = shear.length * shear.width;
  const double gap = grains(scene) * scene.grains.mean_mass() /
                     (shear.volume_fraction * scene.grains.density() * area);
  return layer_bins(scene, (base_thickness(shear.wall) + 1.0) * d, 1.4 * gap + 2.0 * d, area);
}

Bins bins_of(const SimpleShear& shear, const Scene&, const Box& box) {
  return {.axis = ProfileAxis::y,
          .periodic = true,
          .width = box.period.y,
          .area = box.period.x * box.period.z,
          .count = 1,
          .shear_rate = shear.shear_rate};
}

Bins bins_of(const BodyForceBox& force, const Scene& scene, const Box& box) {
  const double start_height =
      grains(scene) * scene.grains.mean_mass() /
      (force.volume_fraction * scene.grains.density() * force.length * force.width);
  const double rows = std::max(4.0, std::round(start_height / scene.measurement.bin_width));
  const double count = rows * static_cast<double>(bins_per_row(scene.measurement));
  return {.axis = ProfileAxis::y,
          .periodic = true,
          .width = box.period.y / count,
          .area = box.period.x * box.period.z,
          .count = static_cast<std::size_t>(count)};
}

/// Of the filling at rest [length].
double height(const SplitBottom& cell, const Scene& scene) {
  const double annulus =
      0.5 * cell.wedge *
      (cell.outer_radius * cell.outer_radius - cell.inner_radius * cell.inner_radius);
  return grains(scene) * scene.grains.mean_mass() /
         (nominal_packing * scene.grains.density() * annulus);
}

/// Cylindrical shells over the whole filling, the last as far as the outer wall or beyond.
Bins bins_of(const SplitBottom& cell, const Scene& scene, const Box&) {
  const double width = scene.measurement.bin_width;
  const double rounding = 1e-9;
  const double rows = std::ceil((cell.outer_radius - cell.inner_radius) / width - rounding);
  const std::size_t fine = bins_per_row(scene.measurement);
  return {.axis = ProfileAxis::radius,
          .begin = cell.inner_radius,
          .width = width / static_cast<double>(fine),
          .area = cell.wedge * height(cell, scene),
          .count = fine * static_cast<std::size_t>(rows)};
}

}  // namespace

Vec3 gravity(double strength, double inclination) {
  return {strength * std::sin(inclination), 0.0, -strength * std::cos(inclination)};
}

SimulationSetup flow_setup(const Scene& scene, const InitialState& initial) {
  SimulationSetup setup;
  setup.dynamics.time_step = time_step(scene);
  setup.density = scene.grains.density();
  setup.max_overlap = scene.max_overlap;
  std::visit([&](const auto& g) { add_geometry(g, scene, initial, setup); }, scene.geometry);
  return setup;
}

std::optional<SimulationSetup> settling_setup(const Scene& scene, const InitialState& initial) {
  if (!scene.start.empty()) return std::nullopt;  // a given start flows at once
  SimulationSetup setup = flow_setup(scene, initial);
  if (const auto* chute = std::get_if<Chute>(&scene.geometry)) {
    setup.dynamics.field = Uniform{gravity(chute->gravity, 0.0)};
  } else if (std::holds_alternative<SplitBottom>(scene.geometry)) {
    setup.drive = Still{};
    std::get<Cylinder>(setup.walls.back().shape).rotation_rate = 0.0;
  } else {
    return std::nullopt;  // packed at their volume fraction: sheared from the first step
  }
  return setup;
}

std::vector<FieldChange> field_changes(const Scene& scene) {
  const auto* chute = std::get_if<Chute>(&scene.geometry);
  if (!chute) return {};
  constexpr double rounding = 1e-6;  // [steps]
  std::vector<FieldChange> changes;
  for (const TiltStep& tilt : chute->tilts) {
    changes.push_back({static_cast<long>(std::ceil(tilt.time / time_step(scene) - rounding)),
                       Uniform{gravity(chute->gravity, tilt.inclination)}});
  }
  return changes;
}

std::size_t bins_per_row(const Measurement& measurement) {
  constexpr double finest = 0.25;  // [width of the kernel]
  const double rounding = 1e-9;
  const double bins = measurement.bin_width / (finest * measurement.kernel.width);
  return static_cast<std::size_t>(std::max(1.0, std::ceil(bins - rounding)));
}

Bins profile_bins(const Scene& scene, const Box& box) {
  return std::visit([&](const auto& g) { return bins_of(g, scene, box); }, scene.geometry);
}

std::optional<RingBins> ring_bins(const Scene& scene) {
  const auto* cell = std::get_if<SplitBottom>(&scene.geometry);
  if (!cell) return std::nullopt;
  const double d = scene.grains.diameter;
  // Grains get no deeper than the floor or the lowest glued one; a flowing surface may bulge.
  const double below = (cell->base_thickness + 1.0) * d;
  const double above = 1.2 * height(*cell, scene) + 4.0 * d;
  return RingBins{.radial = bins_of(*cell, scene, {}),
                  .axial = layer_bins(scene, below, above, 1.0),
                  .wedge = cell->wedge,
                  .bins_per_row = bins_per_row(scene.measurement),
                  .kernel = scene.measurement.kernel};
}

SteadyCriteria steady_criteria(const Scene& scene) {
  SteadyCriteria criteria{.averaging_time = scene.measurement.averaging_time,
                          .rest_velocity = 0.0,
                          .rest_time = INFINITY,
                          .runaway_velocity = INFINITY};
  if (const auto* box = std::get_if<SimpleShear>(&scene.geometry)) {
    criteria.start_up = 1.0 / box->shear_rate;  // it forgets its packing within that strain
    criteria.mean_flow = false;
  } else if (const auto* driven = std::get_if<BodyForceBox>(&scene.geometry)) {
    criteria.mean_flow = false;
    criteria.rest_velocity = 1e-3 * std::sqrt(driven->amplitude * scene.grains.diameter);
    criteria.rest_time = 20.0 * std::sqrt(scene.grains.diameter / driven->amplitude);
  } else if (std::holds_alternative<SplitBottom>(scene.geometry)) {
    // What lies outside the band compacts long after the band is steady.
    criteria.compaction = 0.01;
  } else if (const auto* chute = std::get_if<Chute>(&scene.geometry)) {
    const double d = scene.grains.diameter;
    const double fall = dense_fraction * chute->gravity * std::cos(last_inclination(*chute));
    criteria.drive = chute->gravity * std::sin(last_inclination(*chute));
    if (!chute->tilts.empty()) criteria.last_change = chute->tilts.back().time;
    criteria.rest_velocity = 1e-3 * std::sqrt(chute->gravity * d);
    criteria.rest_time = 20.0 * std::sqrt(d / chute->gravity);
    criteria.runaway_velocity =
        0.4 * std::sqrt(fall) * std::pow(depth(scene.grains, *chute), 1.5) / d;
  }
  return criteria;
}

double unit_time(const Scene& scene) {
  const double d = scene.grains.diameter;
  if (const auto* chute = std::get_if<Chute>(&scene.geometry)) return std::sqrt(d / chute->gravity);
  if (const auto* cell = std::get_if<SplitBottom>(&scene.geometry)) {
    return std::sqrt(d / cell->gravity);
  }
  if (const auto* box = std::get_if<SimpleShear>(&scene.geometry)) return 1.0 / box->shear_rate;
  if (const auto* shear = std::get_if<PlaneShear>(&scene.geometry)) return d / shear->velocity;
  const double pressure = std::get<BodyForceBox>(scene.geometry).pressure;
  return d * std::sqrt(scene.grains.density() / pressure);
}

}  // namespace grainlaw::dem
