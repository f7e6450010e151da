#pragma once

#include <cstdint>
#include <vector>

#include "dem/box.h"
#include "dem/particles.h"
#include "dem/walls.h"

namespace grainlaw::dem {

/// Points behind the real grains that stand for others, so that one loop over pairs serves all:
/// images of grains across the faces of a wedge, and feet of grains on flat or round walls.
struct StandIns {
  std::vector<std::uint32_t> image_of;  ///< real grain of every image
  std::vector<double> image_angle;      ///< by which it is turned about z [rad]
  std::vector<std::uint32_t> foot_of;   ///< mobile grain of every foot, ascending
  std::vector<std::uint32_t> foot_on;   ///< its wall

  /// Lists those that grains nearer than `reach` (surface to surface) need, behind the real grains.
  void list(Particles& particles, const Box& box, const std::vector<Wall>& walls, double reach);

  /// Appends room for them to the particles and brings them up to date.
  void append(Particles& particles, const std::vector<Wall>& walls) const;

  /// Moves them with their grains.
  void update(Particles& particles, const std::vector<Wall>& walls) const;

  /// Hands the loads of images back to their grains.
  void return_loads(Particles& particles) const;

  std::size_t size() const { return image_of.size() + foot_of.size(); }
};

}  // namespace grainlaw::dem
