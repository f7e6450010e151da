#pragma once

#include <cstdint>
#include <vector>

#include "dem/box.h"
#include "dem/scene.h"

namespace grainlaw::dem {

/// Random positions of equal spheres in a box periodic in all directions, moved apart until no
/// overlap exceeds overlap_bound [diameter]. Counter-based random numbers (Philox): equal seeds
/// give equal packings. Throws SceneError when they do not come apart (packing too dense).
std::vector<Vec3> random_packing(const Box& box,
                                 std::size_t grains,
                                 double diameter,
                                 std::uint64_t seed,
                                 double overlap_bound = 1e-3);

/// Where the grains of a chute start, before settling. z = 0: highest base centre + d/2.
struct ChuteGrains {
  Box box;                   ///< periodic in x and y
  std::vector<Vec3> base;    ///< glued
  std::vector<Vec3> column;  ///< flowing
};

/// Cuts base and column from one random packing: the base is the layer of centres of the wanted
/// thickness, the column the scene's number of grains next above it.
ChuteGrains pack_chute(const Scene& scene);

}  // namespace grainlaw::dem
