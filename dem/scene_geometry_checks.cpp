#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "dem/scene_checks.h"

namespace grainlaw::dem {
namespace {

constexpr std::string_view geometry = "geometry";

bool inside(double value, const limits::Interval& interval) {
  return value >= interval.least && value <= interval.most;
}

void check_count(double number, std::string_view what, const Place& at) {
  if (number >= 1.0 && number <= limits::grains) return;
  const std::string bound = number < 1.0 ? "at least 1 must " + std::string(what)
                                         : fmt::format("at most {}", limits::grains);
  refuse(at, fmt::format("grains = {:.0f}: {}", number, bound));
}

/// Grains that move and those packed beside them to cut a base or walls from.
void check_total(double moving, double glued, const Place& at, const std::string& what) {
  if (moving + glued <= limits::grains) return;
  refuse(at,
         fmt::format("{}: {:.7g} moving grains and {:.7g} to cut base or walls from, together at "
                     "most {}; take a smaller one",
                     what,
                     moving,
                     glued,
                     limits::grains));
}

/// What a period has to be at least: grains act on one image of each other, and on none of
/// themselves.
double least_period(const Scene& scene) {
  const double largest = scene.grains.largest();
  return std::max(limits::least_period * largest,
                  limits::least_reaches * (largest + attraction_range(scene)));
}

void check_period(std::string_view name, double period, const Scene& scene) {
  const double least = least_period(scene);
  if (period >= least && std::isfinite(period)) return;
  refuse({geometry, name},
         fmt::format("{} = {:.6g}: the period must be at least {:.6g} ({:.4g} of the largest "
                     "diameter), else a grain meets its own image",
                     name,
                     period,
                     least,
                     least / scene.grains.largest()));
}

void check_volume_fraction(double fraction) {
  if (inside(fraction, limits::volume_fraction)) return;
  refuse({geometry, "volume_fraction"},
         fmt::format("volume_fraction = {:.4g} at the start: must lie in [{}, {}]; denser ones do "
                     "not come apart from random positions",
                     fraction,
                     limits::volume_fraction.least,
                     limits::volume_fraction.most));
}

void check_slab(double thickness,
                double packing_fraction,
                const Place& at_thickness,
                const Place& at_fraction) {
  if (!inside(thickness, limits::base_thickness)) {
    refuse(at_thickness,
           fmt::format("base thickness = {} d: must lie in [{}, {}]; thinner ones have holes",
                       thickness,
                       limits::base_thickness.least,
                       limits::base_thickness.most));
  }
  if (!inside(packing_fraction, limits::base_packing_fraction)) {
    refuse(at_fraction,
           fmt::format("base packing_fraction = {}: must lie in [{}, {}]; looser has holes, denser "
                       "does not come apart from random positions",
                       packing_fraction,
                       limits::base_packing_fraction.least,
                       limits::base_packing_fraction.most));
  }
}

void check_base(const BumpyBase& base, std::string_view section, const Grains&) {
  check_slab(
      base.thickness, base.packing_fraction, {section, "thickness"}, {section, "packing_fraction"});
}
/// The smallest grain has to rest on three neighbours: their distance from the middle of the
/// triangle, spacing/sqrt(3), is below the sum of the radii.
void check_base(const LatticeBase& base, std::string_view section, const Grains& grains) {
  const double hole = std::numbers::sqrt3 * 0.5 * (1.0 + grains.smallest() / grains.diameter);
  const double most = std::min(limits::lattice_spacing.most, hole);
  if (base.spacing >= limits::lattice_spacing.least && base.spacing <= most) return;
  refuse({section, "spacing"},
         fmt::format("lattice spacing = {} d: must lie in [{}, {:.4g}]; the smallest grains fall "
                     "through a wider one",
                     base.spacing,
                     limits::lattice_spacing.least,
                     most));
}
void check_base(const FlatBase&, std::string_view, const Grains&) {}

void check_base(const Base& base, std::string_view section, const Grains& grains) {
  std::visit([&](const auto& recipe) { check_base(recipe, section, grains); }, base);
}
void check_inclination(double inclination, std::string_view key) {
  const double degrees = inclination * 180.0 / std::numbers::pi;
  if (degrees >= 0.0 && degrees < 90.0) return;
  refuse({geometry, key},
         fmt::format("{} = {:.6g} degrees: must lie in [0, 90){}",
                     key,
                     degrees,
                     degrees < 0.0 ? "; a negative tilt flows in -x, where velocity, shear rate "
                                     "and shear stress change sign: mirror the scene"
                                   : ""));
}

void check_tilts(const Chute& chute, const Scene& scene) {
  constexpr Place at{geometry, "tilt_times"};
  double before = 0.0;
  for (const TiltStep& tilt : chute.tilts) {
    check_inclination(tilt.inclination, "tilts");
    if (!(tilt.time > before)) {
      refuse(at, fmt::format("tilt_times: {:.6g} does not follow {:.6g}", tilt.time, before));
    }
    before = tilt.time;
  }
  if (before < scene.measurement.time_limit) return;
  refuse(at,
         fmt::format("tilt_times: the last one, {:.6g}, must be below time_limit = {:.6g}, where "
                     "the run ends",
                     before,
                     scene.measurement.time_limit));
}

void check(const Chute& chute, const Scene& scene) {
  check_inclination(chute.inclination, "inclination");
  check_tilts(chute, scene);
  require_positive(chute.gravity, {geometry, "gravity"}, "gravity");
  check_count(grains(scene), "flow", {geometry, "grains"});
  check_period("length", chute.length, scene);
  check_period("width", chute.width, scene);
  if (!scene.start.empty()) return;
  check_base(chute.base, "geometry.base", scene.grains);
  check_total(chute.grains,
              glued_grains(scene),
              {geometry, "length"},
              fmt::format("length x width = {:.6g} x {:.6g}", chute.length, chute.width));
}

/// p* = p d / k_n is about the overlap of grains over their diameter.
void check_load(std::string_view key, double load, const Scene& scene) {
  constexpr double most = 1.0;
  const auto* hooke = std::get_if<Hooke>(&scene.normal);
  if (hooke == nullptr) return;
  const double softness = load * scene.grains.diameter / hooke->stiffness;
  if (softness < most) return;
  refuse({geometry, key},
         fmt::format("{} = {:.4g}: presses grains into each other by their whole size (p d / k_n = "
                     "{:.3g}, must be below {})",
                     key,
                     load,
                     softness,
                     most));
}

void check(const SimpleShear& shear, const Scene& scene) {
  require_positive(shear.shear_rate, {geometry, "shear_rate"}, "shear_rate");
  if (shear.pressure) require_not_negative(*shear.pressure, {geometry, "pressure"}, "pressure");
  check_load("pressure", shear.pressure.value_or(0.0), scene);
  check_count(grains(scene), "shear", {geometry, "grains"});
  if (!scene.start.empty()) require_positive(shear.size.x, {geometry, "length"}, "length");
  const Vec3 size = start_size(scene.grains, shear);
  check_period("length", size.x, scene);
  check_period("height", size.y, scene);
  check_period("width", size.z, scene);
  const double volume = shear.grains * scene.grains.mean_mass() / scene.grains.density();
  if (scene.start.empty()) check_volume_fraction(volume / (size.x * size.y * size.z));
}

void check(const PlaneShear& shear, const Scene& scene) {
  require_positive(shear.velocity, {geometry, "velocity"}, "velocity");
  if (shear.load) require_positive(*shear.load, {geometry, "load"}, "load");
  check_load("load", shear.load.value_or(0.0), scene);
  require_not_negative(shear.gravity, {geometry, "gravity"}, "gravity");
  check_count(grains(scene), "shear", {geometry, "grains"});
  check_period("length", shear.length, scene);
  check_period("width", shear.width, scene);
  if (!scene.start.empty()) return;
  check_volume_fraction(shear.volume_fraction);
  if (std::holds_alternative<FlatBase>(shear.wall)) {
    refuse({"geometry.wall", "recipe"},
           R"(a flat wall hardly drags the grains: take recipe = "bumpy" or "lattice")");
  }
  check_base(shear.wall, "geometry.wall", scene.grains);
  check_total(shear.grains,
              glued_grains(scene),
              {geometry, "length"},
              fmt::format("length x width = {:.6g} x {:.6g}", shear.length, shear.width));
}

void check(const BodyForceBox& box, const Scene& scene) {
  require_positive(box.amplitude, {geometry, "amplitude"}, "amplitude");
  require_positive(box.pressure, {geometry, "pressure"}, "pressure");
  check_load("pressure", box.pressure, scene);
  check_count(grains(scene), "flow", {geometry, "grains"});
  check_period("length", box.length, scene);
  check_period("width", box.width, scene);
  check_volume_fraction(box.volume_fraction);
  const double height = start_height(scene.grains, box);
  if (height >= least_period(scene)) return;
  refuse({geometry, "grains"},
         fmt::format("grains = {}: fill {:.4g} of the height of the box: at least {:.4g}, else a "
                     "grain meets its own image; take more grains or a smaller base",
                     box.grains,
                     height,
                     least_period(scene)));
}

void check_radii(const SplitBottom& cell) {
  require_positive(cell.inner_radius, {geometry, "inner_radius"}, "inner_radius");
  if (!(cell.split_radius > cell.inner_radius)) {
    refuse({geometry, "split_radius"},
           fmt::format("split_radius = {}: must be above inner_radius = {}",
                       cell.split_radius,
                       cell.inner_radius));
  }
  if (cell.outer_radius > cell.split_radius && std::isfinite(cell.outer_radius)) return;
  refuse({geometry, "outer_radius"},
         fmt::format("outer_radius = {}: must be finite and above split_radius = {}",
                     cell.outer_radius,
                     cell.split_radius));
}

void check_wedge(const SplitBottom& cell, const Scene& scene) {
  constexpr double roundings = 1e-9;  // of degrees turned into radians, and to spare
  const double wedges = 2.0 * std::numbers::pi / cell.wedge;
  const double degrees = cell.wedge * 180.0 / std::numbers::pi;
  const bool whole = std::abs(wedges - std::round(wedges)) < roundings * wedges;
  if (!whole || wedges < limits::least_wedges - roundings * wedges) {
    refuse({geometry, "wedge"},
           fmt::format("wedge = {:.6g} degrees: must be a full turn divided by a whole number of "
                       "at least {}: 90, 72, 60, 45, 30, ...",
                       degrees,
                       limits::least_wedges));
  }
  const double arc = cell.inner_radius * cell.wedge;
  const double least = limits::least_reaches * (scene.grains.largest() + attraction_range(scene));
  if (arc >= least) return;
  refuse({geometry, "wedge"},
         fmt::format("wedge = {:.6g} degrees: {:.4g} wide at the inner cylinder: at least {:.4g} "
                     "({} reaches of the largest grains), else a grain meets its own image",
                     degrees,
                     arc,
                     least,
                     limits::least_reaches));
}

void check(const SplitBottom& cell, const Scene& scene) {
  check_radii(cell);
  check_wedge(cell, scene);
  require_positive(cell.rotation_rate, {geometry, "rotation_rate"}, "rotation_rate");
  require_positive(cell.gravity, {geometry, "gravity"}, "gravity");
  check_count(grains(scene), "flow", {geometry, "grains"});
  if (!scene.start.empty()) return;
  check_slab(cell.base_thickness,
             cell.base_packing_fraction,
             {geometry, "base_thickness"},
             {geometry, "base_packing_fraction"});
  check_total(cell.grains,
              glued_grains(scene),
              {geometry, "outer_radius"},
              fmt::format("outer_radius = {:.6g}", cell.outer_radius));
}

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_start_grain(const StartGrain& grain, std::size_t number, const Grains& grains) {
  constexpr double digits = 1e-6;  // of a diameter written to a file
  constexpr Place at{"start", "grains"};
  const double farthest = limits::start_distance * grains.diameter;
  if (!finite(grain.position) || !finite(grain.velocity) || !finite(grain.rotation)) {
    refuse(at, fmt::format("grain {} of the start: all its numbers must be finite", number));
  }
  if (length(grain.position) > farthest) {
    refuse(at,
           fmt::format("grain {} of the start: {:.4g} from the origin: at most {:.4g}, beyond "
                       "which an overlap drowns in rounding",
                       number,
                       length(grain.position),
                       farthest));
  }
  const double least = grains.smallest();
  const double most = grains.largest();
  if (grain.diameter >= least * (1.0 - digits) && grain.diameter <= most * (1.0 + digits)) return;
  refuse(at,
         fmt::format("grain {} of the start: diameter = {:.7g}: must lie in [{:.7g}, {:.7g}], the "
                     "sizes of size_ratio = {}",
                     number,
                     grain.diameter,
                     least,
                     most,
                     grains.size_ratio));
}

/// Grains with one centre have no direction to be pushed apart in.
void check_centres(const std::vector<StartGrain>& grains) {
  std::vector<std::size_t> order(grains.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto place = [&](std::size_t k) {
    const Vec3& p = grains[k].position;
    return std::tuple(p.x, p.y, p.z);
  };
  std::ranges::sort(order, {}, place);
  const auto same = std::ranges::adjacent_find(order, {}, place);
  if (same == order.end()) return;
  refuse({"start", "grains"},
         fmt::format("grains {} and {} of the start are at one place",
                     std::min(same[0], same[1]) + 1,
                     std::max(same[0], same[1]) + 1));
}

/// Glued grains are the base of a chute unless that is flat, the walls of a plane shear and the
/// bottom of a split cell; periodic boxes have no place for them.
void check_frozen(const Scene& scene) {
  const auto frozen = std::ranges::count(scene.start, true, &StartGrain::frozen);
  const auto* chute = std::get_if<Chute>(&scene.geometry);
  const bool periodic = std::holds_alternative<SimpleShear>(scene.geometry) ||
                        std::holds_alternative<BodyForceBox>(scene.geometry);
  const bool flat = chute != nullptr && std::holds_alternative<FlatBase>(chute->base);
  constexpr Place at{"start", "grains"};
  if (periodic && frozen > 0) {
    refuse(at,
           fmt::format("the start has {} frozen grains: a {} has no base nor walls",
                       frozen,
                       kind(scene.geometry)));
  }
  if (!periodic && !flat && frozen == 0) {
    refuse(at,
           fmt::format("the start has no frozen grains: they are the {}",
                       chute != nullptr ? "base of a chute; or take a flat one"
                                        : fmt::format("walls of a {}", kind(scene.geometry))));
  }
}

void check_start_profile(const Scene& scene) {
  constexpr Place at{"start", "profile"};
  const std::vector<StartVelocity>& profile = scene.start_profile;
  if (profile.empty()) return;
  if (!std::holds_alternative<Chute>(scene.geometry)) {
    refuse(at,
           fmt::format("a start profile is that of a chute, not of a {}", kind(scene.geometry)));
  }
  for (std::size_t k = 0; k < profile.size(); ++k) {
    if (!std::isfinite(profile[k].z) || !std::isfinite(profile[k].velocity)) {
      refuse(at, fmt::format("row {} of the start profile: its numbers must be finite", k + 1));
    }
    if (k > 0 && profile[k].z <= profile[k - 1].z) {
      refuse(at,
             fmt::format("row {} of the start profile: z = {:.6g} is not above the row before it",
                         k + 1,
                         profile[k].z));
    }
  }
}

}  // namespace

void check_geometry(const Scene& scene) {
  std::visit([&](const auto& shape) { check(shape, scene); }, scene.geometry);
}

void check_start(const Scene& scene) {
  check_start_profile(scene);
  if (scene.start.empty()) return;
  for (std::size_t k = 0; k < scene.start.size(); ++k) {
    check_start_grain(scene.start[k], k + 1, scene.grains);
  }
  check_centres(scene.start);
  check_frozen(scene);
  const int stated = std::visit([](const auto& shape) { return shape.grains; }, scene.geometry);
  if (stated != grains(scene)) {
    refuse({geometry, "grains"},
           fmt::format("grains = {}: the start has {} that move", stated, grains(scene)));
  }
  if (scene.start.size() <= static_cast<std::size_t>(limits::grains)) return;
  refuse({"start", "grains"},
         fmt::format("{} grains in the start: at most {}", scene.start.size(), limits::grains));
}

}  // namespace grainlaw::dem
