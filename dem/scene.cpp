#include "dem/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dem/scene_checks.h"

namespace grainlaw::dem {
namespace {

constexpr double default_steps_per_contact = 50.0;

constexpr double never = std::numeric_limits<double>::infinity();

/// The deepest overlap a run accepts, relative to the diameter of two equal grains.
double deepest_overlap(const Scene& scene) {
  return 0.5 * scene.max_overlap;
}

FastestMode normal_mode(const Hooke& law, double mass, double) {
  return {law.contact_time(0.5 * mass), "stiffness", law.stiffness};
}
FastestMode normal_mode(const Hertz& law, double mass, double overlap) {
  return {law.contact_time(0.5 * mass, overlap), "stiffness", law.stiffness};
}

double prefactor(const Hooke&, double) {
  return 1.0;
}
double prefactor(const Hertz&, double overlap) {
  return std::sqrt(overlap);
}

FastestMode tangential_mode(const Frictionless&, double, double) {
  return {never, "", 0.0};
}
template <class Law>
FastestMode tangential_mode(const Law& law, double mass, double prefactor) {
  return {tangential_contact_time(law, mass) / std::sqrt(prefactor),
          "tangential stiffness",
          law.stiffness};
}

FastestMode cohesive_mode(const Cohesionless&, const Grains&) {
  return {never, "", 0.0};
}
template <class Law>
FastestMode cohesive_mode(const Law& law, const Grains& grains) {
  const double slope = law.steepest_slope(0.5 * grains.smallest());
  const double reduced_mass = 0.5 * grains.mass_of(grains.smallest());
  return {std::numbers::pi * std::sqrt(reduced_mass / slope), "slope of the attraction", slope};
}

double range_of(const Cohesionless&) {
  return 0.0;
}
template <class Law>
double range_of(const Law& law) {
  return law.range();
}

void check_grains(const Grains& grains) {
  require_positive(grains.diameter, {"grains", "diameter"}, "grain diameter");
  require_positive(grains.mass, {"grains", "density"}, "grain mass");
  const limits::Interval& allowed = limits::size_ratio;
  if (grains.size_ratio >= allowed.least && grains.size_ratio <= allowed.most) return;
  refuse({"grains", "size_ratio"},
         fmt::format("size_ratio = {}: must lie in [{}, {}], largest diameter over smallest",
                     grains.size_ratio,
                     allowed.least,
                     allowed.most));
}

void check_overlap(double max_overlap) {
  if (max_overlap > 0.0 && max_overlap < limits::overlap) return;
  refuse({"", "max_overlap"},
         fmt::format("max_overlap = {}: must lie in (0, {}), a fraction of the radius",
                     max_overlap,
                     limits::overlap));
}

/// The height that has to hold a bin and its neighbours, and what it is called; 0: none has to.
struct BinnedHeight {
  double height = 0.0;
  std::string name;
};
BinnedHeight binned_height(const Grains& grains, const Chute& chute) {
  return {nominal_depth(grains, chute), "nominal depth"};
}
BinnedHeight binned_height(const Grains& grains, const PlaneShear& shear) {
  return {start_gap(grains, shear), "distance of the walls"};
}
BinnedHeight binned_height(const Grains& grains, const BodyForceBox& box) {
  return {start_height(grains, box), "height of the box"};
}
BinnedHeight binned_height(const Grains&, const SimpleShear&) {
  return {};
}
BinnedHeight binned_height(const Grains&, const SplitBottom&) {
  return {};
}

void check_kernel(const Kernel& kernel, double diameter) {
  const limits::Interval& allowed = limits::kernel_width;
  const double width = kernel.width / diameter;
  if (width >= allowed.least && width <= allowed.most) return;
  refuse({"measurement", "width"},
         fmt::format("width = {}: must lie in [{:.6g}, {:.6g}] ({} to {} d)",
                     kernel.width,
                     allowed.least * diameter,
                     allowed.most * diameter,
                     allowed.least,
                     allowed.most));
}

void check_bins(const Scene& scene) {
  constexpr Place at{"measurement", "bin_width"};
  const double width = scene.measurement.bin_width;
  const double least = limits::least_bin_width * scene.grains.diameter;
  require_positive(width, at, "bin_width");
  check_kernel(scene.measurement.kernel, scene.grains.diameter);
  if (width < least) {
    refuse(at,
           fmt::format("bin_width = {}: must be at least {:.6g} ({} d)",
                       width,
                       least,
                       limits::least_bin_width));
  }
  const BinnedHeight binned = std::visit(
      [&](const auto& geometry) { return binned_height(scene.grains, geometry); }, scene.geometry);
  const double most = binned.height / limits::least_bins;
  if (binned.height == 0.0 || width <= most) return;
  refuse(at,
         fmt::format("bin_width = {}: at most {:.4g}, a third of the {} {:.4g} of {} grains: the "
                     "shear rate of a bin needs a neighbour on both sides; {}",
                     width,
                     most,
                     binned.name,
                     binned.height,
                     grains(scene),
                     most < least ? "take more grains" : "narrow the bins or take more grains"));
}

/// One time of a measurement has to be at least another.
void check_order(double value, double least, std::string_view key, const std::string& bound) {
  if (value >= least && std::isfinite(value)) return;
  refuse({"measurement", key}, fmt::format("{} = {}: must be at least {}", key, value, bound));
}

void check_times(const Measurement& m, double step) {
  require_positive(m.sample_interval, {"measurement", "sample_interval"}, "sample_interval");
  check_order(
      m.sample_interval, step, "sample_interval", fmt::format("one time step ({:.4g})", step));
  check_order(m.frame_interval,
              m.sample_interval,
              "frame_interval",
              fmt::format("sample_interval = {}", m.sample_interval));
  check_order(m.averaging_time,
              4.0 * m.frame_interval,
              "averaging_time",
              fmt::format("4 frames of {}, else no error can be given", m.frame_interval));
  check_order(m.time_limit,
              m.averaging_time,
              "time_limit",
              fmt::format("averaging_time = {}", m.averaging_time));
}

void check_number_of_steps(const Scene& scene) {
  const double step = time_step(scene);
  const double limit = scene.measurement.time_limit;
  if (limit / step <= limits::steps) return;
  refuse({"time", "step"},
         fmt::format("time step = {:.3g}: {:.3g} steps until time_limit = {}, at most {:.0e}; "
                     "lengthen the step or shorten the run",
                     step,
                     limit / step,
                     limit,
                     limits::steps));
}

void check_step(const Scene& scene) {
  constexpr Place at{"time", "step"};
  if (!(scene.time_step >= 0.0 && std::isfinite(scene.time_step))) {
    refuse(at,
           fmt::format("time_step = {}: must be positive, or 0 for the default", scene.time_step));
  }
  const FastestMode mode = fastest_mode(scene);
  const double largest = mode.time / limits::least_steps_per_contact;
  if (scene.allow_unstable_step || scene.time_step <= largest) return;
  throw StepRefused(
      fmt::format("time_step = {:.3g} exceeds 1/15 of the shortest contact time ({:.3g} for "
                  "{} = {:.6g}{}): at most {:.3g}; the default would be {:.3g}",
                  scene.time_step,
                  mode.time,
                  mode.name,
                  mode.stiffness,
                  scene.grains.size_ratio > 1.0 ? " and the smallest grains" : "",
                  largest,
                  mode.time / default_steps_per_contact),
      at.section,
      at.key);
}

double mean_volume(const Grains& grains) {
  return grains.mean_mass() / grains.density();
}

/// Grains packed to cut a slab with centres in a layer and a margin from.
double grains_in_slab(double thickness, double fraction, double area, const Grains& grains) {
  const double volume = (thickness + 2.0) * grains.diameter * area;
  return fraction * volume / mean_volume(grains);
}
double glued(const BumpyBase& base, double area, const Grains& grains) {
  return grains_in_slab(base.thickness, base.packing_fraction, area, grains);
}
double glued(const LatticeBase& base, double area, const Grains& grains) {
  const double spacing = base.spacing * grains.diameter;
  return area / (0.5 * std::numbers::sqrt3 * spacing * spacing);
}
double glued(const FlatBase&, double, const Grains&) {
  return 0.0;
}

double glued(const Base& base, double area, const Grains& grains) {
  return std::visit([&](const auto& recipe) { return glued(recipe, area, grains); }, base);
}

double glued_in(const Chute& chute, const Grains& grains) {
  return glued(chute.base, chute.length * chute.width, grains);
}
double glued_in(const PlaneShear& shear, const Grains& grains) {
  return 2.0 * glued(shear.wall, shear.length * shear.width, grains);
}
double glued_in(const SplitBottom& cell, const Grains& grains) {
  return grains_in_slab(cell.base_thickness, cell.base_packing_fraction, floor_area(cell), grains);
}
double glued_in(const SimpleShear&, const Grains&) {
  return 0.0;
}
double glued_in(const BodyForceBox&, const Grains&) {
  return 0.0;
}

}  // namespace

void refuse(const Place& at, const std::string& message) {
  throw SceneError(message, at.section, at.key);
}

void require_positive(double value, const Place& at, std::string_view what) {
  if (value > 0.0 && std::isfinite(value)) return;
  refuse(at, fmt::format("{} = {}: must be positive and finite", what, value));
}

void require_not_negative(double value, const Place& at, std::string_view what) {
  if (value >= 0.0 && std::isfinite(value)) return;
  refuse(at, fmt::format("{} = {}: must be 0 or positive, and finite", what, value));
}

void validate(const Scene& scene) {
  check_grains(scene.grains);
  check_overlap(scene.max_overlap);
  check_laws(scene);
  check_geometry(scene);
  check_start(scene);
  check_step(scene);
  check_bins(scene);
  check_times(scene.measurement, time_step(scene));
  check_number_of_steps(scene);
  check_lifetimes(scene);
}

FastestMode fastest_mode(const Scene& scene) {
  const double mass = scene.grains.mass_of(scene.grains.smallest());
  const double overlap = deepest_overlap(scene);
  const auto in_normal = [&](const auto& law) { return normal_mode(law, mass, overlap); };
  const auto in_prefactor = [&](const auto& law) { return prefactor(law, overlap); };
  const double factor = std::visit(in_prefactor, scene.normal);
  const auto in_friction = [&](const auto& law) { return tangential_mode(law, mass, factor); };
  const auto in_cohesion = [&](const auto& law) { return cohesive_mode(law, scene.grains); };
  const std::array<FastestMode, 3> modes{std::visit(in_normal, scene.normal),
                                         std::visit(in_friction, scene.friction),
                                         std::visit(in_cohesion, scene.cohesion)};
  return *std::ranges::min_element(modes, {}, &FastestMode::time);
}

double shortest_contact_time(const Scene& scene) {
  return fastest_mode(scene).time;
}

double time_step(const Scene& scene) {
  if (scene.time_step > 0.0) return scene.time_step;
  return shortest_contact_time(scene) / default_steps_per_contact;
}

int grains(const Scene& scene) {
  if (!scene.start.empty()) {
    return static_cast<int>(std::ranges::count(scene.start, false, &StartGrain::frozen));
  }
  return std::visit([](const auto& geometry) { return geometry.grains; }, scene.geometry);
}

double glued_grains(const Scene& scene) {
  if (!scene.start.empty()) {
    return static_cast<double>(std::ranges::count(scene.start, true, &StartGrain::frozen));
  }
  return std::visit([&](const auto& shape) { return glued_in(shape, scene.grains); },
                    scene.geometry);
}

double attraction_range(const Scene& scene) {
  return std::visit([](const auto& law) { return range_of(law); }, scene.cohesion);
}

double mass_per_area(const Grains& grains, const Chute& chute) {
  return chute.grains * grains.mean_mass() / (chute.length * chute.width);
}

double last_inclination(const Chute& chute) {
  return chute.tilts.empty() ? chute.inclination : chute.tilts.back().inclination;
}

double nominal_depth(const Grains& grains, const Chute& chute) {
  return mass_per_area(grains, chute) / (nominal_packing * grains.density());
}

double nominal_depth(const Grains& grains, const SplitBottom& cell) {
  return cell.grains * mean_volume(grains) / (nominal_packing * floor_area(cell));
}

double floor_area(const SplitBottom& cell) {
  return 0.5 * cell.wedge *
         (cell.outer_radius * cell.outer_radius - cell.inner_radius * cell.inner_radius);
}

Vec3 start_size(const Grains& grains, const SimpleShear& shear) {
  if (!(shear.size == Vec3{})) return shear.size;
  const double side = std::cbrt(shear.grains * mean_volume(grains) / shear.volume_fraction);
  return {side, side, side};
}

double start_gap(const Grains& grains, const PlaneShear& shear) {
  return shear.grains * mean_volume(grains) / (shear.volume_fraction * shear.length * shear.width);
}

double start_height(const Grains& grains, const BodyForceBox& box) {
  return box.grains * mean_volume(grains) / (box.volume_fraction * box.length * box.width);
}

}  // namespace grainlaw::dem
