#pragma once

#include <vector>

#include "dem/box.h"
#include "dem/vec3.h"

namespace grainlaw::dem {

/// Rigid bodies that glued grains belong to; mobile grains belong to none.
enum class Body : unsigned char {
  none,   ///< mobile
  base,   ///< rough base, lower wall, or the part of a split bottom at rest
  mover,  ///< upper wall, or the rotating part of a split bottom
};

/// A grain as it is handed to a simulation.
struct InitialGrain {
  Vec3 position{};        ///< [length]
  Vec3 velocity{};        ///< [length/time]
  Vec3 rotation{};        ///< omega [1/time]
  double diameter = 1.0;  ///< [length]
  Body body = Body::none;
};

/// Where the grains of a run start.
struct InitialState {
  Box box{};
  std::vector<InitialGrain> grains{};
};

}  // namespace grainlaw::dem
