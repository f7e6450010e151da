#include "dem/packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/dem/packing_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(RandomPacking, EqualSpheresComeApartAtAVolumeFractionOfSixTenths) {
  const std::vector<double> sizes(800, 1.0);
  const InitialState state = packing(cube_for(sizes, 0.6), sizes, 3);
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(inside_periods(state));
}

TEST(RandomPacking, SpheresTenTimesAsLargeAsOthersComeApart) {
  const std::vector<double> sizes = diameters({.size_ratio = 10.0}, 800, 3);
  const InitialState state = packing(cube_for(sizes, 0.6), sizes, 3);
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(inside_periods(state));
}

TEST(RandomPacking, DependsOnTheSeedAndOnNothingElse) {
  const std::vector<double> sizes(100, 1.0);
  const Box box = cube_for(sizes, 0.55);
  EXPECT_EQ(random_packing(box, sizes, 5), random_packing(box, sizes, 5));
  EXPECT_NE(random_packing(box, sizes, 5), random_packing(box, sizes, 6));
}

TEST(RandomPacking, RefusesWhatIsDenserThanRandomClosePacking) {
  const std::vector<double> sizes(100, 1.0);
  EXPECT_THROW(random_packing(cube_for(sizes, 0.7), sizes, 5), SceneError);
}

TEST(RandomPacking, StopsAtTheFirstSweepItIsToldTo) {
  const std::vector<double> sizes(100, 1.0);
  const Box box = cube_for(sizes, 0.6);
  std::vector<InitialGrain> grains;
  for (const Vec3& place : scatter(region_of(box), sizes.size(), 5))
    grains.push_back({.position = place});
  int asked = 0;
  EXPECT_THROW(come_apart(region_of(box), grains, [&] { return ++asked < 3; }), PackingStopped);
  EXPECT_EQ(asked, 3);
}

TEST(RandomPacking, RefusesABoxInWhichAGrainMeetsItsOwnImage) {
  EXPECT_THROW(random_packing(box_of({1.1, 8.0, 8.0}), std::vector<double>(4, 1.0), 5), SceneError);
}

TEST(Diameters, HaveTheMeanAndTheMeanCubeOfTheGrains) {
  const Grains grains{.diameter = 2.0, .size_ratio = 3.0};
  constexpr int count = 500;
  double mean = 0.0;
  double mean_cube = 0.0;
  for (const double diameter : diameters(grains, count, 1)) {
    mean += diameter / count;
    mean_cube += std::pow(diameter, 3) / count;
    EXPECT_GT(diameter, grains.smallest());
    EXPECT_LT(diameter, grains.largest());
  }
  const double wanted_cube = grains.mean_mass() / grains.mass * std::pow(grains.diameter, 3);
  const double range = grains.largest() - grains.smallest();
  // Midpoint rule: <D^3> of the middles is short by range^2 d / (4 count^2), and nothing else.
  const double short_by = range * range * grains.diameter / (4.0 * count * count);
  const double sum_rounding = count * 1e-16;
  EXPECT_NEAR(mean, grains.diameter, sum_rounding * grains.diameter);
  EXPECT_NEAR(mean_cube, wanted_cube - short_by, sum_rounding * wanted_cube);
}

TEST(Diameters, ComeInAnOrderThatDependsOnTheSeed) {
  const Grains grains{.size_ratio = 2.0};
  EXPECT_EQ(diameters(grains, 50, 1), diameters(grains, 50, 1));
  EXPECT_NE(diameters(grains, 50, 1), diameters(grains, 50, 2));
  EXPECT_FALSE(std::ranges::is_sorted(diameters(grains, 50, 1)));
}

TEST(ChutePacking, AColumnRestsOnAGluedLayerWhoseTopIsTheOrigin) {
  const InitialState state = initial_state(scene_of(chute(600)));
  const auto base = part(state, Body::base);
  const auto flowing = part(state, Body::none);
  EXPECT_EQ(flowing.size(), 600u);
  EXPECT_TRUE(part(state, Body::mover).empty());
  EXPECT_NEAR(highest_centre(base), -0.5, 1e-12);
  EXPECT_GE(lowest_centre(base), -0.5 - BumpyBase{}.thickness);
  EXPECT_GE(lowest_centre(flowing), highest_centre(base));
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_EQ(state.box.period, (Vec3{8.0, 8.0, 0.0}));
  EXPECT_TRUE(inside_periods(state));
  EXPECT_TRUE(at_rest(state.grains));
}

TEST(ChutePacking, TheBaseHasThePackingFractionOfItsRecipe) {
  Chute thick = chute(1, BumpyBase{.thickness = 8.0});
  thick.length = thick.width = 16.0;
  const auto base = part(initial_state(scene_of(thick)), Body::base);
  // A window of a packing counts grains cut by its two faces, one diameter deep, in or out: far
  // less than the square root of the number in that surface layer.
  const double in_surface = 2.0 * 16.0 * 16.0 * 0.585 / (std::numbers::pi / 6.0);
  const double expected = 0.585 * 16.0 * 16.0 * 8.0 / (std::numbers::pi / 6.0);
  EXPECT_NEAR(static_cast<double>(base.size()), expected, std::sqrt(in_surface));
}

TEST(ChutePacking, UnequalGrainsFlowInExactlyTheirSizesOverABaseOfTheSame) {
  const Scene scene = scene_of(chute(500), 3.0);
  const InitialState state = initial_state(scene);
  auto wanted = diameters(scene.grains, 500, scene.seed);
  std::sort(wanted.begin(), wanted.end());
  EXPECT_EQ(sorted_diameters(part(state, Body::none)), wanted);
  const auto base = sorted_diameters(part(state, Body::base));
  EXPECT_LT(base.front(), 0.6);
  EXPECT_GT(base.back(), 1.4);
  EXPECT_LE(worst_overlap(state), rounding);
}

TEST(ChutePacking, ALatticeBaseIsOneLayerNoDenserThanItsSpacing) {
  const InitialState state = initial_state(scene_of(chute(200, LatticeBase{}), 2.0));
  const auto base = part(state, Body::base);
  // 8 in a row, and 4 pairs of rows sqrt(3) wide in a width of 8.
  EXPECT_EQ(base.size(), 64u);
  for (const InitialGrain& grain : base) {
    EXPECT_EQ(grain.position.z, -0.5);
    EXPECT_EQ(grain.diameter, 1.0);
  }
  auto loose = base;
  for (InitialGrain& grain : loose) grain.body = Body::none;
  EXPECT_LE(worst_overlap({.box = state.box, .grains = loose}), 1e-12);
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(inside_periods(state));
}

TEST(ChutePacking, GrainsOnAFlatBaseKeepAboveIt) {
  const InitialState state = initial_state(scene_of(chute(200, FlatBase{}), 2.0));
  EXPECT_EQ(state.grains.size(), 200u);
  for (const InitialGrain& grain : state.grains) {
    EXPECT_GE(grain.position.z, 0.5 * grain.diameter);
  }
  EXPECT_LE(worst_overlap(state), rounding);
}

TEST(ChutePacking, SidewallsTakeThePlaceOfThePeriodAcrossTheFlow) {
  for (const Base& base : {Base{BumpyBase{.packing_fraction = 0.6}}, Base{LatticeBase{}}}) {
    Chute channel = chute(150, base);
    channel.width = 3.0;
    channel.sidewalls = Sidewalls{};
    const InitialState state = initial_state(scene_of(channel));
    EXPECT_EQ(state.box.period.y, 0.0);
    for (const InitialGrain& grain : state.grains) {
      EXPECT_GE(grain.position.y, 0.5 * grain.diameter);
      EXPECT_LE(grain.position.y, 3.0 - 0.5 * grain.diameter);
    }
    EXPECT_LE(worst_overlap(state), rounding);
  }
}

}  // namespace
}  // namespace grainlaw::dem
