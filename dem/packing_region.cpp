#include "dem/packing_region.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::dem {
namespace {

bool inside(const Extent& extent, double value) {
  return value >= extent.least && value < extent.most;
}

double wrapped_into(const Extent& period, double value) {
  const double c = value - period.length() * std::floor((value - period.least) / period.length());
  return inside(period, c) ? c : period.least;  // rounding can end at the upper end
}

double held_between(const Extent& walls, double value, double radius) {
  if (walls.periodic) return value;
  const double least = walls.least + radius;
  return std::clamp(value, least, std::max(least, walls.most - radius));
}

bool is_angle(const Region& region, std::size_t axis) {
  return region.polar && axis == 1;
}

Repeat repeat(const Region& region, const std::array<int, 3>& steps) {
  // An axis between walls has no step; its length may be infinite.
  const auto step = [&](std::size_t axis) {
    return steps[axis] == 0 ? 0.0 : steps[axis] * region.axes[axis].length();
  };
  if (!region.polar) return {.steps = steps, .shift = {step(0), step(1), step(2)}};
  return {.steps = steps,
          .cosine = std::cos(step(1)),
          .sine = std::sin(step(1)),
          .shift = {0.0, 0.0, step(2)}};
}

}  // namespace

Coordinates Region::coordinates(const Vec3& p) const {
  if (!polar) return {p.x, p.y, p.z};
  return {std::hypot(p.x, p.y), std::atan2(p.y, p.x), p.z};
}

Vec3 Region::position(const Coordinates& c) const {
  if (!polar) return {c[0], c[1], c[2]};
  return {c[0] * std::cos(c[1]), c[0] * std::sin(c[1]), c[2]};
}

double Region::volume() const {
  const double arc = polar ? 0.5 * (axes[0].least + axes[0].most) : 1.0;
  return axes[0].length() * arc * axes[1].length() * axes[2].length();
}

Vec3 Region::wrapped(const Vec3& p) const {
  Coordinates c = coordinates(p);
  bool moved = false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!axes[axis].periodic || inside(axes[axis], c[axis])) continue;
    c[axis] = wrapped_into(axes[axis], c[axis]);
    moved = true;
  }
  return moved ? position(c) : p;
}

Vec3 Region::held(const Vec3& p, double radius) const {
  const double z = held_between(axes[2], p.z, radius);
  if (!polar) {
    return {held_between(axes[0], p.x, radius), held_between(axes[1], p.y, radius), z};
  }
  const double distance = std::hypot(p.x, p.y);
  const double scale = held_between(axes[0], distance, radius) / distance;
  return {scale * p.x, scale * p.y, z};
}

double Region::shortest_repeat() const {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!axes[axis].periodic) continue;
    const double chord = 2.0 * axes[0].least * std::sin(0.5 * axes[axis].length());
    shortest = std::min(shortest, is_angle(*this, axis) ? chord : axes[axis].length());
  }
  return shortest;
}

bool Repeat::meets(const Region& region, const Coordinates& point, double reach) const {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (steps[axis] == 0) continue;
    const Extent& extent = region.axes[axis];
    // At the radius point[0] a face of a sector is as far away as the reach at this angle from it.
    const double margin =
        is_angle(region, axis) ? std::asin(std::min(1.0, reach / point[0])) : reach;
    const double image = point[axis] + steps[axis] * extent.length();
    if (image < extent.least - margin || image >= extent.most + margin) return false;
  }
  return true;
}

std::vector<Repeat> repeats(const Region& region) {
  std::vector<Repeat> result;
  for (int k = 0; k < 27; ++k) {
    const std::array<int, 3> steps{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    bool possible = steps != std::array<int, 3>{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (steps[axis] != 0 && !region.axes[axis].periodic) possible = false;
    }
    if (possible) result.push_back(repeat(region, steps));
  }
  return result;
}

}  // namespace grainlaw::dem
