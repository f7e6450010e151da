#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "dem/box.h"
#include "dem/initial_state.h"
#include "dem/packing_region.h"

namespace grainlaw::dem {

/// Asked between two sweeps or steps of long work; false: it is to stop. Absent: it is not asked.
using KeepGoing = std::function<bool()>;

/// Grains are not where a flow could start: the work was told to stop.
struct PackingStopped {};

/// Throws PackingStopped.
inline void stop_unless(const KeepGoing& keep_going) {
  if (keep_going && !keep_going()) throw PackingStopped{};
}

/// Four numbers in (0, 1) that depend on nothing but the seed and k (Philox, counter based).
std::array<double, 4> random_numbers(std::uint64_t seed, std::uint32_t k);

/// The block a box covers; its open axes do not count.
Region region_of(const Box& box);

/// Points uniform in the region; point k depends on the seed and k only.
std::vector<Vec3> scatter(const Region& region, std::size_t count, std::uint64_t seed);

/// Moves mobile grains apart until none overlaps another (to rounding); the heavier of two moves
/// less, a glued one not at all.
/// Leaves the grains inside the region. Throws SceneError when they do not come apart, or when the
/// region repeats after less than the reach of the largest grain; PackingStopped.
void come_apart(const Region& region,
                std::vector<InitialGrain>& grains,
                const KeepGoing& keep_going = {});

/// Random positions of spheres in a box periodic in all directions, moved apart as above, in the
/// order of the diameters. Equal seeds give equal packings. Equal spheres come apart up to a volume
/// fraction of 0.6 within seconds; towards random close packing, 0.64, no longer.
std::vector<Vec3> random_packing(const Box& box,
                                 std::span<const double> diameters,
                                 std::uint64_t seed);

}  // namespace grainlaw::dem
