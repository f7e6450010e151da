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

/// Verlet list of all pairs whose surfaces are closer than range + skin, each once, at least one
/// grain of it mobile. Pairs are sorted by their first grain, which is mobile; partners are mobile
/// ones further on, frozen ones and images. Cells are sorted with the slowest index along z.
class NeighbourList {
 public:
  NeighbourList(double range, double skin) : range_(range), skin_(skin) {}

  /// The permutation that sorts the real grains by cell, mobile ones first: new place -> old place.
  /// Grains must lie in the box.
  std::vector<std::uint32_t> cell_order(const Particles& particles, const Box& box) const;

  /// Builds the list for grains in the order of cell_order() with the images behind them. The last
  /// points are feet: `foot_of` names their mobile grains, in ascending order.
  void build(const Particles& particles,
             const Box& box,
             std::span<const std::uint32_t> foot_of = {});

  double skin() const { return skin_; }
  double reach(double radius_sum) const { return radius_sum + range_ + skin_; }  ///< [length]
  std::size_t pairs() const { return row_begin_.back(); }
  /// First grain and partner of every pair; pack_width words behind the last may be read.
  const std::uint32_t* first() const { return first_.data(); }
  const Partner* partners() const { return partners_.data(); }
  /// Pairs of row i: [row_begin(i), row_begin(i + 1)).
  std::uint32_t row_begin(std::size_t i) const { return row_begin_[i]; }

  /// Goes on with a list made elsewhere.
  void restore(std::vector<std::uint32_t> row_begin, std::vector<Partner> partners);

 private:
  void close();

  double range_;
  double skin_;
  std::vector<std::uint32_t> row_begin_{0};
  std::vector<std::uint32_t> first_;
  std::vector<Partner> partners_;
};

}  // namespace grainlaw::dem
