#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "dem/box.h"
#include "dem/particles.h"

namespace grainlaw::dem {

/// Partner of a pair: index of the grain in the low 27 bits, its image above.
struct Partner {
  std::uint32_t bits;

  static Partner of(std::size_t grain, Image image) {
    return {static_cast<std::uint32_t>(grain) | image << 27};
  }
  std::uint32_t grain() const { return bits & 0x7ffffffu; }
  Image image() const { return bits >> 27; }
};

/// Verlet list of all pairs closer than reach + skin, each once, at least one grain of it mobile.
/// Row i holds the partners j > i of mobile grain i, so frozen grains are only ever partners.
class NeighbourList {
 public:
  NeighbourList(const Box& box, double reach, double skin);

  /// The permutation that sorts grains by cell, mobile ones first: new place -> old place. Grains
  /// must lie in the box.
  std::vector<std::uint32_t> cell_order(const Particles& particles) const;

  /// Builds the list for grains in the order of cell_order().
  void build(const Particles& particles);

  double skin() const { return skin_; }
  std::size_t pairs() const { return partners_.size(); }
  std::span<const Partner> partners() const { return partners_; }
  /// Pairs of row i: [row_begin(i), row_begin(i + 1)).
  std::uint32_t row_begin(std::size_t i) const { return row_begin_[i]; }

 private:
  struct Grid;
  Grid grid(const Particles& particles) const;

  Box box_;
  double cutoff_;
  double skin_;
  std::vector<std::uint32_t> row_begin_{0};
  std::vector<Partner> partners_;
};

}  // namespace grainlaw::dem
