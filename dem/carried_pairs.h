#pragma once

#include <cstdint>
#include <vector>

#include "dem/acting_pairs.h"
#include "dem/neighbour_list.h"
#include "dem/particles.h"
#include "dem/stand_ins.h"

namespace grainlaw::dem {

/// What acting pairs remember, by grain numbers, while the list is rebuilt. The only place where a
/// memory changes sides: springs are stored as seen from the first grain of their pair, and turn
/// with it when it passes a face of a wedge.
class CarriedPairs {
 public:
  CarriedPairs(const Particles& particles,
               const NeighbourList& list,
               const std::vector<Strip>& strips,
               const StandIns& stand_ins,
               const PairMemory& memory);

  /// Puts the memories to their pairs in the new list and marks these as active. `turns`: of
  /// wrap(), empty without a wedge.
  void restore(const Particles& particles,
               const NeighbourList& list,
               const std::vector<double>& turns,
               PairMemory& memory) const;

 private:
  struct Entry {
    std::uint32_t first_id;
    std::uint32_t second_id;
    double second_angle;  ///< of the image that stood for the second grain [rad]
    PairMemory::Spring spring;
    std::uint8_t bridge;
  };
  std::vector<Entry> entries_;
};

}  // namespace grainlaw::dem
