#include <cstring>

#include "dem/contact_lifetimes.h"

namespace grainlaw::dem {
namespace {

constexpr std::size_t numbers_per_tally =
    LifetimeAxis::bins * sizeof(LifetimeCounts) / sizeof(double);

}  // namespace

void ContactLifetimes::save(Checkpoint& to) const {
  std::vector<double> blocks;
  for (const LifetimeBlock& block : blocks_) {
    blocks.insert(blocks.end(), {block.begin, block.end, block.samples, block.grains});
    for (const LifetimeTally& tally : block.distances) {
      blocks.insert(blocks.end(), {tally.begun, tally.unknown, tally.unfinished});
      const auto* first = reinterpret_cast<const double*>(tally.bins.data());
      blocks.insert(blocks.end(), first, first + numbers_per_tally);
    }
  }
  std::vector<double> tracks;
  std::vector<std::int64_t> open;
  for (const Kept& kept : in_contact()) {
    open.insert(open.end(), {kept.ids.first, kept.ids.second, kept.within});
    for (const Track& t : kept.tracks) {
      tracks.insert(tracks.end(), {t.begin, t.touches, t.slides, t.shear, t.normal});
    }
  }
  to.numbers["lifetimes/blocks"] = std::move(blocks);
  to.numbers["lifetimes/tracks"] = std::move(tracks);
  to.integers["lifetimes/pairs"] = std::move(open);
  to.integers["lifetimes/counters"] = {frames_, rebuilds_, last_look_};
}

void ContactLifetimes::restore(const Checkpoint& from) {
  const std::vector<double>& numbers = entry(from.numbers, "lifetimes/blocks");
  if (numbers.size() % (4 + kinds() * (3 + numbers_per_tally)) != 0) {
    throw CheckpointError("the lifetimes of another scene");
  }
  blocks_.clear();
  for (auto at = numbers.begin(); at != numbers.end();) {
    LifetimeBlock& block = blocks_.emplace_back(new_block(*at++));
    block.end = *at++, block.samples = *at++, block.grains = *at++;
    for (LifetimeTally& tally : block.distances) {
      tally.begun = *at++, tally.unknown = *at++, tally.unfinished = *at++;
      std::memcpy(static_cast<void*>(tally.bins.data()), &*at, numbers_per_tally * sizeof(double));
      at += numbers_per_tally;
    }
  }
  constexpr std::size_t per_pair = 3, per_track = 5;
  const auto& open = entry(from.integers, "lifetimes/pairs");
  const std::size_t count = open.size() / per_pair;
  const auto& tracks = entry(from.numbers, "lifetimes/tracks", per_track * kinds() * count);
  ids_.clear(), within_.clear(), tracks_.clear();
  auto number = tracks.begin();
  for (std::size_t pair = 0; pair < count; ++pair) {
    const auto word = [&](std::size_t k) {
      return static_cast<std::uint32_t>(open[pair * per_pair + k]);
    };
    Kept kept{.ids = {word(0), word(1)}, .within = word(2), .tracks = {}};
    for (std::size_t kind = 0; kind < kinds(); ++kind, number += per_track) {
      kept.tracks.push_back({number[0], number[1], number[2], number[3], number[4]});
    }
    add_candidate(kept.ids, &kept);
  }
  const auto& counters = entry(from.integers, "lifetimes/counters", 3);
  frames_ = counters[0];
  rebuilds_ = counters[1];
  last_look_ = counters[2];
  choose_anew_ = true;
}

}  // namespace grainlaw::dem
