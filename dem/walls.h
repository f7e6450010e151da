#pragma once

#include <cmath>
#include <variant>

#include "dem/vec3.h"

namespace grainlaw::dem {

/// A plane that grains stay above.
struct Plane {
  Vec3 point{};
  Vec3 normal{};  ///< unit vector into the grains

  double distance(const Vec3& p) const { return dot(p - point, normal); }
  Vec3 foot(const Vec3& p) const { return p - distance(p) * normal; }
  Vec3 velocity(const Vec3&) const { return {}; }
};

/// A cylinder about z, turning at a given rate.
struct Cylinder {
  double radius = 1.0;
  bool grains_inside = true;
  double rotation_rate = 0.0;  ///< [1/time]

  double distance(const Vec3& p) const {
    const double gap = radius - std::hypot(p.x, p.y);
    return grains_inside ? gap : -gap;
  }
  Vec3 foot(const Vec3& p) const {
    const double scale = radius / std::hypot(p.x, p.y);
    return {scale * p.x, scale * p.y, p.z};
  }
  Vec3 velocity(const Vec3& p) const { return {-rotation_rate * p.y, rotation_rate * p.x, 0.0}; }
};

/// A smooth or frictional wall: a partner of radius 0 and infinite mass at the nearest point, under
/// the same contact law as grains.
struct Wall {
  std::variant<Plane, Cylinder> shape;
  bool frictional = true;

  double distance(const Vec3& p) const {
    return std::visit([&](const auto& s) { return s.distance(p); }, shape);
  }
  Vec3 foot(const Vec3& p) const {
    return std::visit([&](const auto& s) { return s.foot(p); }, shape);
  }
  Vec3 velocity(const Vec3& foot) const {
    return std::visit([&](const auto& s) { return s.velocity(foot); }, shape);
  }
};

}  // namespace grainlaw::dem
