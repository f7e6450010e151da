// Can a grain fall through a bumpy base?
#include "dem/base_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dem/packing_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// Places of a sphere of diameter d = 1 on a cubic grid about a base of such spheres, periodic in x
/// and y: does a chain of free ones lead from above to the lowest centre? Without regard to speed.
class FreePlaces {
 public:
  FreePlaces(const std::vector<InitialGrain>& base, double side)
      : count_(static_cast<int>(std::ceil(20.0 * side))),
        edge_(side / count_),
        lowest_(lowest_centre(base)),
        levels_(static_cast<int>((highest_centre(base) + 1.1 - lowest_) / edge_)) {
    free_.assign(static_cast<std::size_t>(count_ * count_ * levels_), true);
    for (const InitialGrain& grain : base) take(grain, static_cast<int>(1.0 / edge_) + 1);
  }

  bool lead_through() {
    std::vector<std::array<int, 3>> reached{{0, 0, levels_ - 1}};
    while (!reached.empty()) {
      const auto [i, j, k] = reached.back();
      reached.pop_back();
      if (k < 0) return true;
      if (k >= levels_ || !free_[at(i, j, k)]) continue;
      free_[at(i, j, k)] = false;
      reached.insert(reached.end(), {{i + 1, j, k}, {i - 1, j, k}, {i, j + 1, k}, {i, j - 1, k}});
      reached.insert(reached.end(), {{i, j, k + 1}, {i, j, k - 1}});
    }
    return false;
  }

 private:
  void take(const InitialGrain& grain, int reach) {
    const Vec3& c = grain.position;
    const int ci = cells(c.x), cj = cells(c.y), ck = cells(c.z - lowest_);
    for (int i = ci - reach; i <= ci + reach; ++i) {
      for (int j = cj - reach; j <= cj + reach; ++j) {
        for (int k = std::max(0, ck - reach); k <= std::min(levels_ - 1, ck + reach); ++k) {
          const Vec3 place{i * edge_, j * edge_, lowest_ + k * edge_};
          if (length(place - c) < 1.0) free_[at(i, j, k)] = false;
        }
      }
    }
  }
  int cells(double distance) const { return static_cast<int>(std::lround(distance / edge_)); }
  std::size_t at(int i, int j, int k) const {
    const auto wrapped = [&](int n) { return (n % count_ + count_) % count_; };
    return static_cast<std::size_t>((k * count_ + wrapped(j)) * count_ + wrapped(i));
  }

  int count_;
  double edge_;
  double lowest_;
  int levels_;
  std::vector<bool> free_;
};

std::vector<InitialGrain> base_of(double side, const BumpyBase& recipe, std::uint64_t seed) {
  Chute flow = chute(1, recipe);
  flow.length = flow.width = side;
  Scene scene = scene_of(flow);
  scene.seed = seed;
  return part(initial_state(scene), Body::base);
}

/// A lattice of n x 2 n grains in rows `spacing` apart, three neighbours around every hollow.
std::vector<InitialGrain> lattice(double spacing, int n) {
  std::vector<InitialGrain> grains;
  for (int row = 0; row < 2 * n; ++row) {
    for (int column = 0; column < n; ++column) {
      grains.push_back({.position = {(column + 0.5 * (row % 2)) * spacing,
                                     0.5 * std::numbers::sqrt3 * row * spacing,
                                     -0.5},
                        .body = Body::base});
    }
  }
  return grains;
}

std::size_t plugs_of_lattice(double spacing, double diameter) {
  constexpr int n = 4;
  const Region ground{{{{0.0, n * spacing}, {0.0, n * std::numbers::sqrt3 * spacing}, {0.0, 1.0}}}};
  return hole_plugs(ground, lattice(spacing, n), diameter).size();
}

TEST(BaseHoles, OfALatticeAreThoseItsTrianglesLeave) {
  // Between three grains a sphere passes whose centre is spacing/sqrt(3) from theirs: one of
  // diameter D where spacing > sqrt(3) (d + D)/2. The finer grid tells D to 7 %.
  constexpr double width = std::numbers::sqrt3;
  for (const double diameter : {1.0, 0.5}) {
    const double widest = 0.5 * (1.0 + diameter) * width;
    EXPECT_EQ(plugs_of_lattice(0.5 * (1.0 + 0.93 * diameter) * width, diameter), 0u);
    // Of 64 triangles; a plug off the middle of one may narrow the three beside it.
    EXPECT_GE(plugs_of_lattice(1.001 * widest, diameter), 16u);
  }
}

TEST(BaseHoles, AreRareInTheUsualBaseAndClosedThere) {
  std::vector<std::uint64_t> plugged;
  for (std::uint64_t seed = 93; seed <= 107; ++seed) {
    const auto base = base_of(7.0, {}, seed);
    EXPECT_FALSE(FreePlaces(base, 7.0).lead_through()) << seed;
    EXPECT_EQ(highest_centre(base), -0.5);
    const double lowest = lowest_centre(base);
    const auto at_bottom = std::count_if(
        base.begin(), base.end(), [&](const InitialGrain& g) { return g.position.z == lowest; });
    if (at_bottom > 1) plugged.push_back(seed);  // at the height of the lowest grain
  }
  EXPECT_EQ(plugged, (std::vector<std::uint64_t>{102}));
}

TEST(BaseHoles, AreClosedInThinAndLooseBases) {
  for (const double side : {5.0, 7.0}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const auto base = base_of(side, {.thickness = 1.0, .packing_fraction = 0.4}, seed);
      EXPECT_FALSE(FreePlaces(base, side).lead_through()) << side << ' ' << seed;
      EXPECT_NEAR(highest_centre(base), -0.5, rounding);
    }
  }
}

TEST(BaseHoles, AcrossTheFaceOfARingAreClosedBetweenItsWalls) {
  const SplitBottom cell = small_ring();
  const Region ring{
      {{{cell.inner_radius, cell.outer_radius, false}, {0.0, cell.wedge}, {0.0, 1.0}}}, true};
  std::vector<InitialGrain> base;
  for (const InitialGrain& grain : initial_state(scene_of(cell)).grains) {
    if (grain.body != Body::none) base.push_back(grain);
  }
  EXPECT_TRUE(hole_plugs(ring, base, 1.0).empty());
  const Vec3 at_wall = ring.position({cell.outer_radius, 0.0, -1.0});
  const auto near = [&](const Vec3& p) {
    return std::min({length(p - at_wall),
                     length(turned(p, cell.wedge) - at_wall),
                     length(turned(p, -cell.wedge) - at_wall)}) < 1.8;
  };
  std::erase_if(base, [&](const InitialGrain& grain) { return near(grain.position); });
  const auto plugs = hole_plugs(ring, base, 1.0);
  EXPECT_FALSE(plugs.empty());
  for (const InitialGrain& plug : plugs) {
    EXPECT_TRUE(near(plug.position));
    const double radius = std::hypot(plug.position.x, plug.position.y);
    EXPECT_LE(radius, cell.outer_radius - 0.5 + rounding);
  }
  base.insert(base.end(), plugs.begin(), plugs.end());
  EXPECT_TRUE(hole_plugs(ring, base, 1.0).empty());
}

}  // namespace
}  // namespace grainlaw::dem
