#include "dem/carried_pairs.h"

#include <limits>
#include <optional>

namespace grainlaw::dem {
namespace {

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

/// The pair of the row of grain `place` whose partner has this number.
std::optional<std::uint32_t> find(const Particles& particles,
                                  const NeighbourList& list,
                                  std::uint32_t place,
                                  std::uint32_t partner_id) {
  if (place >= particles.mobile) return std::nullopt;
  for (auto pair = list.row_begin(place); pair < list.row_begin(place + 1); ++pair) {
    if (particles.id[list.partners()[pair].grain()] == partner_id) return pair;
  }
  return std::nullopt;
}

/// Place of every number; walls have none.
std::vector<std::uint32_t> places(const Particles& particles) {
  std::vector<std::uint32_t> place(particles.real, nowhere);
  for (std::uint32_t i = 0; i < particles.real; ++i) place[particles.id[i]] = i;
  return place;
}

}  // namespace

CarriedPairs::CarriedPairs(const Particles& particles,
                           const NeighbourList& list,
                           const std::vector<Strip>& strips,
                           const StandIns& stand_ins,
                           const PairMemory& memory) {
  for (const Strip& strip : strips) {
    for (std::size_t k = 0; k < strip.acting.count; ++k) {
      const std::uint32_t pair = strip.acting.pair[k];
      const std::uint32_t partner = list.partners()[pair].grain();
      const bool image =
          partner >= particles.real && partner < particles.real + stand_ins.image_of.size();
      entries_.push_back(
          {.first_id = particles.id[strip.acting.first[k]],
           .second_id = particles.id[partner],
           .second_angle = image ? stand_ins.image_angle[partner - particles.real] : 0.0,
           .spring = memory.spring.empty() ? PairMemory::Spring{} : memory.spring[pair],
           .bridge = memory.bridge.empty() ? std::uint8_t{0} : memory.bridge[pair]});
    }
  }
}

void CarriedPairs::restore(const Particles& particles,
                           const NeighbourList& list,
                           const std::vector<double>& turns,
                           PairMemory& memory) const {
  const std::vector<std::uint32_t> place = places(particles);
  for (const Entry& entry : entries_) {
    const bool wall = entry.second_id >= first_wall_id;
    const std::uint32_t first = place[entry.first_id];
    const std::uint32_t second = wall ? nowhere : place[entry.second_id];
    PairMemory::Spring spring = entry.spring;
    double turn = turns.empty() ? 0.0 : turns[first];
    auto pair = find(particles, list, first, entry.second_id);
    if (!pair && !wall) {
      pair = find(particles, list, second, entry.first_id);
      spring.stretch = -spring.stretch;
      if (!turns.empty()) turn = turns[second] - entry.second_angle;
    }
    if (!pair) continue;  // farther apart than the skin: cannot have acted
    if (turn != 0.0) spring.stretch = turned(spring.stretch, turn);
    if (!memory.spring.empty()) memory.spring[*pair] = spring;
    if (!memory.bridge.empty()) memory.bridge[*pair] = entry.bridge;
    memory.active[*pair] = 1;
  }
}

}  // namespace grainlaw::dem
