#pragma once

#include <array>
#include <vector>

#include "dem/box.h"
#include "dem/vec3.h"

namespace grainlaw::dem {

/// One coordinate of a region: it repeats, or walls at both ends keep the surfaces of grains
/// inside.
struct Extent {
  double least = 0.0;
  double most = 0.0;
  bool periodic = true;

  double length() const { return most - least; }
};

/// x, y, z, or radius, angle about z [rad], z.
using Coordinates = std::array<double, 3>;

/// Where grains are packed: a block in x, y, z, or a sector in radius, angle, z. The radius of a
/// sector lies between walls, its angle repeats by rotation.
struct Region {
  std::array<Extent, 3> axes;
  bool polar = false;

  Coordinates coordinates(const Vec3& p) const;
  Vec3 position(const Coordinates& c) const;
  double volume() const;  ///< [length^3]

  /// The image of a point that lies inside the periods.
  Vec3 wrapped(const Vec3& p) const;

  /// The nearest centre at which a grain does not cut into a wall.
  Vec3 held(const Vec3& p, double radius) const;

  /// The least distance between a point between the walls and an image of it [length].
  double shortest_repeat() const;
};

/// Rotation about z, then a shift: brings a region to one of its repeats.
struct Repeat {
  std::array<int, 3> steps{};  ///< in periods of every axis
  double cosine = 1.0;
  double sine = 0.0;
  Vec3 shift{};

  Vec3 of(const Vec3& p) const { return turned(p, cosine, sine) + shift; }

  /// Whether the image of a point of the region lies within reach of the region.
  bool meets(const Region& region, const Coordinates& point, double reach) const;
};

/// The nearest repeats of a region, itself left out: up to 26.
std::vector<Repeat> repeats(const Region& region);

}  // namespace grainlaw::dem
