// Packings of every flow but the chute: do they fill what they should, at rest or moving?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/packing.h"
#include "tests/dem/packing_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(SimpleShearPacking, FillsACubeAtTheWantedVolumeFractionAndMovesAffinely) {
  const InitialState state = initial_state(scene_of(simple_shear(400), 3.0));
  EXPECT_EQ(part(state, Body::none).size(), 400u);
  EXPECT_NEAR(solid_volume(state.grains) / state.box.volume(), 0.58, 1e-12);
  EXPECT_EQ(state.box.period.x, state.box.period.y);
  EXPECT_EQ(state.box.period.x, state.box.period.z);
  for (const InitialGrain& grain : state.grains) {
    EXPECT_EQ(grain.velocity.x, 0.3 * (grain.position.y - 0.5 * state.box.period.y));
  }
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(inside_periods(state));
}

TEST(SimpleShearPacking, TakesTheSizeOfTheBoxWhereOneIsGiven) {
  SimpleShear shear = simple_shear(100);
  shear.size = {4.0, 5.0, 6.0};
  const InitialState state = initial_state(scene_of(shear));
  EXPECT_EQ(state.box.period, (Vec3{4.0, 5.0, 6.0}));
  EXPECT_LE(worst_overlap(state), rounding);
}

TEST(PlaneShearPacking, FillsTheGapBetweenTwoWallsAtTheWantedVolumeFraction) {
  const InitialState state = initial_state(scene_of(plane_shear(600), 2.0));
  const auto lower = part(state, Body::base);
  const auto upper = part(state, Body::mover);
  const auto flowing = part(state, Body::none);
  const double gap = lowest_centre(upper) - 0.5;
  EXPECT_EQ(flowing.size(), 600u);
  EXPECT_NEAR(highest_centre(lower), -0.5, 1e-12);
  EXPECT_NEAR(solid_volume(flowing) / (8.0 * 8.0 * gap), 0.58, 1e-12);
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(at_rest(lower));
  for (const InitialGrain& grain : upper) EXPECT_EQ(grain.velocity, (Vec3{2.0, 0.0, 0.0}));
  for (const InitialGrain& grain : flowing) {
    EXPECT_NEAR(grain.velocity.x, 2.0 * grain.position.z / gap, 1e-12);
  }
  EXPECT_TRUE(inside_periods(state));
}

TEST(PlaneShearPacking, TheUpperWallIsNotTheImageOfTheLowerOne) {
  const InitialState state = initial_state(scene_of(plane_shear(300)));
  EXPECT_NE(part(state, Body::base).front().position.x,
            part(state, Body::mover).front().position.x);
}

TEST(BodyForceBoxPacking, TheHeightFollowsFromTheVolumeFraction) {
  const BodyForceBox flow{.length = 6.0, .width = 5.0, .grains = 400, .volume_fraction = 0.58};
  const InitialState state = initial_state(scene_of(flow));
  EXPECT_EQ(state.box.period.x, 6.0);
  EXPECT_EQ(state.box.period.z, 5.0);
  EXPECT_NEAR(solid_volume(state.grains) / state.box.volume(), 0.58, 1e-12);
  EXPECT_LE(worst_overlap(state), rounding);
  EXPECT_TRUE(inside_periods(state));
  EXPECT_TRUE(at_rest(state.grains));
}

TEST(SplitBottomPacking, GrainsKeepBetweenTheCylindersAndInsideTheSector) {
  const SplitBottom ring = small_ring();
  const InitialState state = initial_state(scene_of(ring, 2.0));
  EXPECT_EQ(part(state, Body::none).size(), 400u);
  EXPECT_EQ(state.box.period, Vec3{});
  EXPECT_EQ(state.box.wedge, ring.wedge);
  for (const InitialGrain& grain : state.grains) {
    const double radius = std::hypot(grain.position.x, grain.position.y);
    const double angle = std::atan2(grain.position.y, grain.position.x);
    EXPECT_GE(radius, ring.inner_radius + 0.5 * grain.diameter - rounding);
    EXPECT_LE(radius, ring.outer_radius - 0.5 * grain.diameter + rounding);
    EXPECT_GE(angle, -rounding);
    EXPECT_LE(angle, ring.wedge + rounding);
  }
  EXPECT_TRUE(at_rest(state.grains));
}

TEST(SplitBottomPacking, FlowingGrainsOverlapNoRotationalImageOfAnyGrain) {
  const SplitBottom ring = small_ring();
  const InitialState state = initial_state(scene_of(ring, 2.0));
  EXPECT_LE(worst_overlap_in_sector(state.grains, ring.wedge), rounding);
}

TEST(SplitBottomPacking, TheGluedLayerIsAPackingUnderRotationAndSplitAtItsRadius) {
  const SplitBottom ring = small_ring();
  const InitialState state = initial_state(scene_of(ring, 2.0));
  std::vector<InitialGrain> glued = part(state, Body::base);
  for (const InitialGrain& grain : glued) {
    EXPECT_LE(std::hypot(grain.position.x, grain.position.y), ring.split_radius);
  }
  for (const InitialGrain& grain : part(state, Body::mover)) {
    EXPECT_GT(std::hypot(grain.position.x, grain.position.y), ring.split_radius);
    glued.push_back(grain);
  }
  EXPECT_NEAR(highest_centre(glued), -0.5, 1e-12);
  for (InitialGrain& grain : glued) grain.body = Body::none;
  EXPECT_LE(worst_overlap_in_sector(glued, ring.wedge), rounding);
}

}  // namespace
}  // namespace grainlaw::dem
