#include "dem/packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dem/base_holes.h"

namespace grainlaw::dem {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// What random numbers are for; each purpose has a seed of its own.
enum class Purpose : std::uint32_t { sizes, positions, base, upper_wall };

std::uint64_t seed_for(Purpose purpose, std::uint64_t seed) {
  // The complement: seeds of purposes are no point of a packing of this seed.
  const auto random = random_numbers(~seed, static_cast<std::uint32_t>(purpose));
  const auto bits = [](double unit) { return static_cast<std::uint64_t>(unit * 0x1p32); };
  return bits(random[0]) << 32 | bits(random[1]);
}

double total_volume(std::span<const double> diameters) {
  double sum = 0.0;
  for (const double diameter : diameters) sum += diameter * diameter * diameter;
  return std::numbers::pi / 6.0 * sum;
}

double mean_volume(const Grains& grains) {
  return grains.mean_mass() / grains.density();
}

Region with_height(const Region& ground, const Extent& height) {
  return {{ground.axes[0], ground.axes[1], height}, ground.polar};
}

/// Grains next to a flat wall leave gaps: a packing between walls has room for as many as the bulk
/// would have if each wall stood d/8 further inside. (Measured: equal grains between walls 3 d
/// apart come apart up to 0.55, in the bulk up to 0.6 and beyond.)
double volume_without_wall_gaps(Region region, double d) {
  for (Extent& axis : region.axes) {
    if (axis.periodic) continue;
    axis.least += d / 8.0;
    axis.most -= d / 8.0;
  }
  return region.volume();
}

std::vector<InitialGrain> scattered(const Region& region,
                                    std::span<const double> diameters,
                                    std::uint64_t seed) {
  const std::vector<Vec3> points =
      scatter(region, diameters.size(), seed_for(Purpose::positions, seed));
  std::vector<InitialGrain> grains(points.size());
  for (std::size_t k = 0; k < grains.size(); ++k) {
    grains[k].position = points[k];
    grains[k].diameter = diameters[k];
  }
  return grains;
}

/// Glued layer that ends at z = 0: highest centre + d/2.
std::vector<InitialGrain> layer(const BumpyBase& base,
                                const Region& ground,
                                const Grains& grains,
                                std::uint64_t seed,
                                const KeepGoing& keep_going) {
  const double thickness = base.thickness * grains.diameter;
  // Well above the layer: a packing with a short period jams early.
  const Extent height{0.0, thickness + 4.0 * grains.largest()};
  const Region slab = with_height(ground, height);
  const auto count = static_cast<std::size_t>(base.packing_fraction *
                                              volume_without_wall_gaps(slab, grains.diameter) /
                                              mean_volume(grains));
  std::vector<InitialGrain> cut = scattered(slab, diameters(grains, count, seed), seed);
  come_apart(slab, cut, keep_going);
  std::erase_if(cut, [&](const InitialGrain& grain) { return grain.position.z >= thickness; });
  if (cut.empty()) {
    throw SceneError(
        fmt::format("a packing of {} grains leaves none in the base; enlarge length and width",
                    count),
        "geometry",
        "length");
  }
  double highest = 0.0;
  for (const InitialGrain& grain : cut) highest = std::max(highest, grain.position.z);
  for (InitialGrain& grain : cut) {
    grain.position.z -= highest + 0.5 * grains.diameter;
    grain.body = Body::base;
  }
  const std::vector<InitialGrain> plugs = hole_plugs(ground, cut, grains.diameter);
  cut.insert(cut.end(), plugs.begin(), plugs.end());
  return cut;
}

/// Places that divide the extent evenly, at least `spacing` apart and as close as fits: a multiple
/// of `multiple` in a period; between walls the outermost touch them with their diameter.
std::vector<double> evenly(const Extent& extent, double spacing, int multiple, double diameter) {
  const double room = extent.periodic ? extent.length() : extent.length() - diameter;
  constexpr double rounding = 1e-9;  // a period that fits exactly is not to lose a grain
  const int fitting = static_cast<int>(room / (multiple * spacing) + rounding);
  const int intervals = multiple * std::max(1, fitting);
  const double step = room / intervals;
  const double first = extent.least + 0.5 * (extent.periodic ? step : diameter);
  std::vector<double> places(intervals + (extent.periodic ? 0 : 1), first);
  for (std::size_t k = 0; k < places.size(); ++k) places[k] += static_cast<double>(k) * step;
  return places;
}

std::vector<InitialGrain> layer(const LatticeBase& base,
                                const Region& ground,
                                const Grains& grains,
                                std::uint64_t,
                                const KeepGoing&) {
  const double d = grains.diameter;
  const double spacing = base.spacing * d;
  const std::vector<double> columns = evenly(ground.axes[0], spacing, 1, d);
  const double half = 0.5 * ground.axes[0].length() / static_cast<double>(columns.size());
  const bool walls = !ground.axes[1].periodic;
  // Every other row is shifted by half a spacing: a period holds an even number of them.
  const std::vector<double> rows =
      evenly(ground.axes[1], 0.5 * std::numbers::sqrt3 * spacing, walls ? 1 : 2, d);
  std::vector<InitialGrain> lattice;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (const double column : columns) {
      const double x = row % 2 == 0 ? column - half : column;
      lattice.push_back({.position = {x, rows[row], -0.5 * d},
                         .velocity = {},
                         .rotation = {},
                         .diameter = d,
                         .body = Body::base});
    }
  }
  return lattice;
}

std::vector<InitialGrain> layer(
    const FlatBase&, const Region&, const Grains&, std::uint64_t, const KeepGoing&) {
  return {};
}

std::vector<InitialGrain> layer(const Base& base,
                                const Region& ground,
                                const Grains& grains,
                                std::uint64_t seed,
                                const KeepGoing& keep_going) {
  const std::uint64_t own = seed_for(Purpose::base, seed);
  return std::visit([&](const auto& b) { return layer(b, ground, grains, own, keep_going); }, base);
}

/// How far the surface of a flowing grain may reach below z = 0 into the hollows of the base, so
/// that no centre starts below the highest glued one.
double hollows(const Base& base, const Grains& grains) {
  if (std::holds_alternative<FlatBase>(base)) return 0.0;
  return 0.5 * (grains.diameter + grains.smallest());
}

Body glued_body(const SplitBottom& cell, const Vec3& p) {
  return std::hypot(p.x, p.y) > cell.split_radius ? Body::mover : Body::base;
}

std::vector<double> flowing_diameters(const Scene& scene) {
  const int count =
      std::visit([](const auto& geometry) { return geometry.grains; }, scene.geometry);
  return diameters(scene.grains, static_cast<std::size_t>(count), scene.seed);
}

/// Mobile grains spread over heights, moved apart and away from the glued ones between floor and
/// ceiling; followed by the glued ones.
std::vector<InitialGrain> fill(const Region& ground,
                               const Extent& heights,
                               const Extent& walls,
                               std::span<const double> diameters,
                               std::span<const InitialGrain> glued,
                               std::uint64_t seed,
                               const KeepGoing& keep_going) {
  std::vector<InitialGrain> grains = scattered(with_height(ground, heights), diameters, seed);
  grains.insert(grains.end(), glued.begin(), glued.end());
  come_apart(with_height(ground, walls), grains, keep_going);
  return grains;
}

/// A layer with a free surface on its base.
std::vector<InitialGrain> column(const Region& ground,
                                 const Scene& scene,
                                 std::span<const InitialGrain> base,
                                 double depth_below,
                                 const KeepGoing& keep_going) {
  const std::vector<double> sizes = flowing_diameters(scene);
  // The ground is 1 high: its volume is its area.
  const double height = total_volume(sizes) / (nominal_packing * ground.volume());
  return fill(
      ground, {0.0, height}, {-depth_below, infinity, false}, sizes, base, scene.seed, keep_going);
}

/// The ground plane of a geometry, 1 high.
Region ground(const Chute& chute) {
  return {{{{0.0, chute.length}, {0.0, chute.width, !chute.sidewalls}, {0.0, 1.0}}}};
}
Region ground(const PlaneShear& shear) {
  return {{{{0.0, shear.length}, {0.0, shear.width}, {0.0, 1.0}}}};
}
Region ground(const SplitBottom& cell) {
  return {{{{cell.inner_radius, cell.outer_radius, false}, {0.0, cell.wedge}, {0.0, 1.0}}}, true};
}

Box repeating(const Vec3& period) {
  Box box;
  box.period = period;
  return box;
}

/// The box of a geometry around grains of the given total volume.
Box box(const Chute& chute, double) {
  return repeating({chute.length, chute.sidewalls ? 0.0 : chute.width, 0.0});
}
Box box(const SimpleShear& shear, double solid) {
  if (shear.size.x > 0.0) return repeating(shear.size);
  const double edge = std::cbrt(solid / shear.volume_fraction);
  return repeating({edge, edge, edge});
}
Box box(const PlaneShear& shear, double) {
  return repeating({shear.length, shear.width, 0.0});
}
Box box(const BodyForceBox& flow, double solid) {
  const double height = solid / (flow.volume_fraction * flow.length * flow.width);
  return repeating({flow.length, height, flow.width});
}
Box box(const SplitBottom& cell, double) {
  Box sector;
  sector.wedge = cell.wedge;
  return sector;
}

std::vector<InitialGrain> packed(const Chute& chute,
                                 const Box&,
                                 const Scene& scene,
                                 const KeepGoing& keep_going) {
  const Region plane = ground(chute);
  const auto base = layer(chute.base, plane, scene.grains, scene.seed, keep_going);
  return column(plane, scene, base, hollows(chute.base, scene.grains), keep_going);
}

std::vector<InitialGrain> packed(const SplitBottom& cell,
                                 const Box&,
                                 const Scene& scene,
                                 const KeepGoing& keep_going) {
  const Region sector = ground(cell);
  const Base recipe =
      BumpyBase{.thickness = cell.base_thickness, .packing_fraction = cell.base_packing_fraction};
  auto base = layer(recipe, sector, scene.grains, scene.seed, keep_going);
  for (InitialGrain& grain : base) grain.body = glued_body(cell, grain.position);
  return column(sector, scene, base, hollows(recipe, scene.grains), keep_going);
}

/// The layer turned upside down: its z = 0 becomes `height`.
void hang(std::vector<InitialGrain>& wall, double height, double velocity) {
  for (InitialGrain& grain : wall) {
    grain.position.z = height - grain.position.z;
    grain.velocity.x = velocity;
    grain.body = Body::mover;
  }
}

std::vector<InitialGrain> packed(const PlaneShear& shear,
                                 const Box&,
                                 const Scene& scene,
                                 const KeepGoing& keep_going) {
  const Region plane = ground(shear);
  const std::vector<double> sizes = flowing_diameters(scene);
  const double gap = total_volume(sizes) / (shear.volume_fraction * plane.volume());
  auto glued = layer(shear.wall, plane, scene.grains, scene.seed, keep_going);
  auto upper =
      layer(shear.wall, plane, scene.grains, seed_for(Purpose::upper_wall, scene.seed), keep_going);
  hang(upper, gap, shear.velocity);
  glued.insert(glued.end(), upper.begin(), upper.end());
  const double below = hollows(shear.wall, scene.grains);
  auto all =
      fill(plane, {0.0, gap}, {-below, gap + below, false}, sizes, glued, scene.seed, keep_going);
  for (InitialGrain& grain : all) {
    if (grain.body == Body::none) grain.velocity.x = shear.velocity * grain.position.z / gap;
  }
  return all;
}

/// A packing that fills a box periodic in all directions.
std::vector<InitialGrain> packed_box(const Box& box,
                                     const Scene& scene,
                                     const KeepGoing& keep_going) {
  const Region region = region_of(box);
  auto grains = scattered(region, flowing_diameters(scene), scene.seed);
  come_apart(region, grains, keep_going);
  return grains;
}

std::vector<InitialGrain> packed(const BodyForceBox&,
                                 const Box& box,
                                 const Scene& scene,
                                 const KeepGoing& keep_going) {
  return packed_box(box, scene, keep_going);
}

std::vector<InitialGrain> packed(const SimpleShear& shear,
                                 const Box& box,
                                 const Scene& scene,
                                 const KeepGoing& keep_going) {
  auto grains = packed_box(box, scene, keep_going);
  for (InitialGrain& grain : grains) {
    grain.velocity.x = shear.shear_rate * (grain.position.y - 0.5 * box.period.y);
  }
  return grains;
}

Body frozen_body(const Geometry& geometry, const Vec3& p, double middle) {
  if (const auto* cell = std::get_if<SplitBottom>(&geometry)) return glued_body(*cell, p);
  const bool above = std::holds_alternative<PlaneShear>(geometry) && p.z > middle;
  return above ? Body::mover : Body::base;
}

std::vector<InitialGrain> given(const Scene& scene, const Box& box) {
  const auto [lowest, highest] = std::minmax_element(
      scene.start.begin(), scene.start.end(), [](const StartGrain& a, const StartGrain& b) {
        return a.position.z < b.position.z;
      });
  const double middle = 0.5 * (lowest->position.z + highest->position.z);
  const Region region = region_of(box);
  std::vector<InitialGrain> grains;
  for (const StartGrain& grain : scene.start) {
    grains.push_back(
        {.position = region.wrapped(grain.position),
         .velocity = grain.velocity,
         .rotation = grain.rotation,
         .diameter = grain.diameter,
         .body = grain.frozen ? frozen_body(scene.geometry, grain.position, middle) : Body::none});
  }
  return grains;
}

double mobile_volume(const std::vector<StartGrain>& start) {
  std::vector<double> mobile;
  for (const StartGrain& grain : start) {
    if (!grain.frozen) mobile.push_back(grain.diameter);
  }
  return total_volume(mobile);
}

}  // namespace

std::vector<double> diameters(const Grains& grains, std::size_t count, std::uint64_t seed) {
  std::vector<double> result(count);
  const double range = grains.largest() - grains.smallest();
  for (std::size_t k = 0; k < count; ++k) {
    result[k] =
        grains.smallest() + range * (static_cast<double>(k) + 0.5) / static_cast<double>(count);
  }
  // Fisher and Yates by hand: std::shuffle differs between standard libraries.
  const std::uint64_t own = seed_for(Purpose::sizes, seed);
  for (std::size_t k = count; k > 1; --k) {
    const double random = random_numbers(own, static_cast<std::uint32_t>(k))[0];
    std::swap(result[k - 1], result[static_cast<std::size_t>(random * static_cast<double>(k))]);
  }
  return result;
}

InitialState initial_state(const Scene& scene, const KeepGoing& keep_going) {
  const double solid =
      scene.start.empty() ? total_volume(flowing_diameters(scene)) : mobile_volume(scene.start);
  return std::visit(
      [&](const auto& geometry) {
        const Box around = box(geometry, solid);
        return InitialState{.box = around,
                            .grains = scene.start.empty()
                                          ? packed(geometry, around, scene, keep_going)
                                          : given(scene, around)};
      },
      scene.geometry);
}

InitialState moving(InitialState state, const std::vector<StartVelocity>& profile) {
  if (profile.empty()) return state;
  for (InitialGrain& grain : state.grains) {
    if (grain.body != Body::none) continue;
    const auto above = std::ranges::lower_bound(profile, grain.position.z, {}, &StartVelocity::z);
    if (above == profile.begin() || above == profile.end()) {
      grain.velocity.x += above == profile.end() ? profile.back().velocity : above->velocity;
      continue;
    }
    const StartVelocity& below = *std::prev(above);
    const double shear_rate = (above->velocity - below.velocity) / (above->z - below.z);
    grain.velocity.x += below.velocity + shear_rate * (grain.position.z - below.z);
    grain.rotation.y += 0.5 * shear_rate;
  }
  return state;
}

}  // namespace grainlaw::dem
