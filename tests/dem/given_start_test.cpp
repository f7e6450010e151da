// Starts that are given, and what else shapes an initial state.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dem/packing.h"
#include "tests/dem/packing_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(InitialState, DependsOnTheSceneOnly) {
  for (const Geometry& geometry : {Geometry{chute(200)},
                                   Geometry{simple_shear(200)},
                                   Geometry{plane_shear(200)},
                                   Geometry{BodyForceBox{.grains = 200}},
                                   Geometry{small_ring()}}) {
    Scene scene = scene_of(geometry, 2.0);
    const InitialState state = initial_state(scene);
    EXPECT_TRUE(equal(state, initial_state(scene)));
    scene.seed = 12;
    EXPECT_FALSE(equal(state, initial_state(scene)));
  }
}

StartGrain start_grain(const Vec3& position, bool frozen) {
  StartGrain grain;
  grain.position = position;
  grain.velocity = {0.1, 0.2, 0.3};
  grain.frozen = frozen;
  return grain;
}

TEST(GivenStart, IsTakenInItsOrderWithFrozenGrainsAsTheBase) {
  Scene scene = scene_of(chute(1));
  scene.start = {start_grain({-1.0, 9.0, -0.5}, true), start_grain({1.0, 1.0, 2.0}, false)};
  const InitialState state = initial_state(scene);
  ASSERT_EQ(state.grains.size(), 2u);
  EXPECT_EQ(state.grains[0].body, Body::base);
  EXPECT_EQ(state.grains[0].position, (Vec3{7.0, 1.0, -0.5}));
  EXPECT_EQ(state.grains[1].body, Body::none);
  EXPECT_EQ(state.grains[1].velocity, (Vec3{0.1, 0.2, 0.3}));
}

TEST(GivenStart, FrozenGrainsOfTheUpperHalfAreTheMovingWall) {
  Scene scene = scene_of(plane_shear(1));
  scene.start = {start_grain({1.0, 1.0, -0.5}, true),
                 start_grain({1.0, 1.0, 2.0}, false),
                 start_grain({1.0, 1.0, 6.5}, true)};
  const InitialState state = initial_state(scene);
  EXPECT_EQ(state.grains[0].body, Body::base);
  EXPECT_EQ(state.grains[2].body, Body::mover);
}

TEST(GivenStart, FrozenGrainsOutsideTheSplitRotate) {
  Scene scene = scene_of(small_ring());
  scene.start = {start_grain({6.0, 3.0, -0.5}, true), start_grain({6.0, 4.0, -0.5}, true)};
  const InitialState state = initial_state(scene);
  EXPECT_EQ(state.grains[0].body, Body::base);
  EXPECT_EQ(state.grains[1].body, Body::mover);
}

TEST(StartProfile, GivesGrainsTheVelocityAndHalfTheVorticityOfTheirHeight) {
  InitialState state;
  for (const double z : {-0.3, 0.5, 1.5, 9.0}) state.grains.push_back({.position = {0.0, 0.0, z}});
  state.grains.push_back({.position = {0.0, 0.0, 1.0}, .body = Body::base});
  state = moving(state, {{0.0, 0.1}, {1.0, 0.5}, {2.0, 0.7}});
  const double velocity[] = {0.1, 0.3, 0.6, 0.7, 0.0};
  const double rotation[] = {0.0, 0.2, 0.1, 0.0, 0.0};  // about y: that of v_x(z) is half its slope
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(state.grains[k].velocity.x, velocity[k], 1e-15) << k;
    EXPECT_NEAR(state.grains[k].rotation.y, rotation[k], 1e-15) << k;
  }
}

}  // namespace
}  // namespace grainlaw::dem
