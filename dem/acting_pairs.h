#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "dem/box.h"
#include "dem/integrator.h"
#include "dem/simd.h"

namespace grainlaw::dem {

/// Pairs as parallel arrays, in the order of the neighbour list. Up to pack_width words behind the
/// last pair may be read and written.
struct PairArrays {
  std::size_t count = 0;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> partner;  ///< Partner::bits
  std::vector<std::uint32_t> load;     ///< where the force on the partner is added
  std::vector<std::uint32_t> pair;     ///< place in the neighbour list

  void reserve(std::size_t pairs) {
    for (auto* words : {&first, &partner, &load, &pair}) {
      if (words->size() < pairs + pack_width) words->resize(pairs + pack_width);
    }
  }
};

/// What listed pairs remember, kept only where the law has a history.
struct PairMemory {
  struct alignas(32) Spring {
    Vec3 stretch;           ///< [length]
    double slipping = 0.0;  ///< 1: slips (StickSlip)
  };
  std::uint32_t pairs = 0;           ///< of the list; the place behind serves lanes without a pair
  std::vector<Spring> spring;        ///< where the law has friction
  std::vector<std::uint8_t> bridge;  ///< 1: a liquid bridge
  std::vector<std::uint8_t> active;  ///< 1: acted at the last step; only while pairs are searched

  /// Forgets everything and makes room.
  template <class Law>
  void reset(std::size_t listed) {
    pairs = static_cast<std::uint32_t>(listed);
    if constexpr (Law::rotates) spring.assign(listed + 1, {});
    if constexpr (Law::bridges) bridge.assign(listed + 1, 0);
    if constexpr (Law::keeps_history) active.assign(listed + pack_width, 0);
  }
};

/// Sums over the contacts of one step.
struct ContactSums {
  double tangential_energy = 0.0;  ///< in the tangential springs now [energy]
  double normal_dashpot = 0.0;     ///< dissipated in this step [energy]
  double tangential_dashpot = 0.0;
  double slip = 0.0;
  double spring_lost = 0.0;      ///< springs of contacts that opened in this step
  double prefactor_work = 0.0;   ///< taken from tangential springs by a falling Hertz prefactor
  double bridge_lost = 0.0;      ///< bridges that ruptured in this step
  double virial_yy = 0.0;        ///< sum of force times branch along y [energy]
  double largest_overlap = 0.0;  ///< of the smaller radius

  ContactSums& operator+=(const ContactSums& b);
};

/// A stretch of mobile grains and their rows of the list. How grains are cut into strips depends on
/// the scene alone; threads take strips, so that no sum depends on their number.
struct Strip {
  std::size_t begin = 0;  ///< grains
  std::size_t end = 0;
  PairArrays near;                        ///< listed pairs that may act before the next search
  std::vector<std::uint8_t> near_active;  ///< a bit per near pair: acted at the last step
  PairArrays acting;                      ///< pairs that act at this step
  ContactSums sums;                       ///< of this step
  Motion motion;                          ///< of this step
  std::array<Row8, 27> image_load;        ///< forces across moving images, on the first grain
};

/// What every contact of a run has in common.
struct ContactSetting {
  double time_step = 0.0;        ///< [time]
  bool equal_sizes = true;       ///< one radius for all grains
  bool moving_images = false;    ///< Lees-Edwards: forces across images are summed by image
  double smallest_radius = 0.5;  ///< [length]
  std::array<ImageShift, 27> shifts;
};

}  // namespace grainlaw::dem
