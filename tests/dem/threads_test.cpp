// Are all numbers the same on any number of threads, and is no memory raced for?
#include <gtest/gtest.h>

#include "dem/contact_lifetimes.h"
#include "tests/dem/checkpoint_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// Enough grains for three strips, in a box that shears under pressure.
Scene several_strips() {
  return with(small_shear(10.0, 6100), rough(soft, 0.5), 50.0);
}

TEST(Threads, RestartIsExact) {
  expect_same_path(several_strips(), rough(soft, 0.5), 150, 150, 2);
}

TEST(Threads, DoNotChangeAnyNumber) {
  const Scene scene = several_strips();
  const auto path = [&](int threads) {
    Simulation simulation = flow(scene, rough(soft, 0.5), threads);
    EXPECT_EQ(simulation.strips().size(), 3u);
    for (int k = 0; k < 100; ++k) simulation.step();
    return state(simulation);
  };
  const Checkpoint one = path(1);
  for (const int threads : {2, 3, 5}) EXPECT_EQ(differences(one, path(threads)), "") << threads;
}

TEST(Threads, DoNotChangeContactLifetimes) {
  Scene scene = several_strips();
  scene.lifetimes = Lifetimes{.contact_distances = {1.0, 1.001, 1.01, 1.02}};
  const auto followed = [&](int threads) {
    Simulation simulation = flow(scene, rough(soft, 0.5), threads);
    ContactLifetimes lifetimes(scene);
    for (int k = 0; k < 150; ++k) simulation.step(), lifetimes.follow(simulation);
    Checkpoint checkpoint;
    lifetimes.save(checkpoint);
    return checkpoint;
  };
  EXPECT_EQ(differences(followed(1), followed(2)), "");
}

}  // namespace
}  // namespace grainlaw::dem
