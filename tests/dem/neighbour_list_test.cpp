#include "dem/neighbour_list.h"

#include <gtest/gtest.h>

#include <set>
#include <tuple>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;
using PairSet = std::set<std::tuple<std::uint32_t, std::uint32_t, Image>>;

/// All pairs closer than the cutoff, every image tried: the simple truth.
PairSet all_pairs(const Particles& particles, const Box& box, double cutoff) {
  const auto shifts = box.image_shifts();
  PairSet pairs;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    for (std::uint32_t j = i + 1; j < particles.size(); ++j) {
      for (Image image = 0; image < 27; ++image) {
        const bool open_direction = (box.period.x == 0.0 && image % 3 != 1) ||
                                    (box.period.y == 0.0 && image / 3 % 3 != 1) ||
                                    (box.period.z == 0.0 && image / 9 != 1);
        if (open_direction) continue;
        const Vec3 there = particles.state[j].position + shifts[image];
        if (length(particles.state[i].position - there) < cutoff) pairs.insert({i, j, image});
      }
    }
  }
  return pairs;
}

PairSet listed_pairs(const NeighbourList& list, const Particles& particles) {
  PairSet pairs;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    for (auto k = list.row_begin(i); k < list.row_begin(i + 1); ++k) {
      const Partner partner = list.partners()[k];
      EXPECT_TRUE(pairs.insert({i, partner.grain(), partner.image()}).second)
          << "pair listed twice";
    }
  }
  return pairs;
}

class NeighbourListOf : public testing::TestWithParam<Vec3> {};

TEST_P(NeighbourListOf, EqualsBruteForce) {
  const Box box{GetParam()};
  Vec3 extent = box.period;
  if (extent.z == 0.0) extent.z = 6.0;
  InitialState initial;
  initial.position = random_packing(Box{extent}, 100, 1.0, 3);
  initial.frozen.assign(initial.position.begin(), initial.position.begin() + 20);
  initial.position.erase(initial.position.begin(), initial.position.begin() + 20);
  initial.position.push_back({1.0, 1.0, extent.z * 50.0});  // far above all others
  if (box.period.z > 0.0) initial.position.pop_back();
  Particles particles = make_particles(initial, false);
  NeighbourList list(box, 1.0, 0.3);
  reorder(particles, list.cell_order(particles));
  list.build(particles);
  const PairSet expected = all_pairs(particles, box, 1.3);
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(listed_pairs(list, particles), expected);
}

// 3 d is the smallest period allowed: two cells along it, each the neighbour of the other twice.
INSTANTIATE_TEST_SUITE_P(Boxes,
                         NeighbourListOf,
                         testing::Values(Vec3{8.0, 5.5, 0.0},
                                         Vec3{5.0, 6.5, 4.0},
                                         Vec3{3.0, 3.0, 14.0}));

TEST(NeighbourList, TrajectoryDoesNotDependOnWhenItIsRebuilt) {
  // Other skins rebuild, and sort, at other times; histories must come along. Sums are then added
  // in another order: equal to rounding, which chaos multiplies, hence the short run.
  const double step = soft.collision_time(0.5) / 50.0;
  auto start = gas(4.0, 60, 1.0, step);
  start.setup.skin = 0.02;
  Simulation often(rough(soft, 0.5), start.setup, start.initial);
  start.setup.skin = 0.4;
  Simulation rarely(rough(soft, 0.5), start.setup, start.initial);
  for (int k = 0; k < 600; ++k) {
    often.step();
    rarely.step();
  }
  EXPECT_GT(often.rebuilds(), 3 * rarely.rebuilds());
  std::vector<Vec3> a(60), b(60);
  for (std::size_t i = 0; i < 60; ++i) {
    a[often.particles().id[i]] = often.velocity(i);
    b[rarely.particles().id[i]] = rarely.velocity(i);
  }
  for (std::size_t i = 0; i < 60; ++i) EXPECT_LT(length(a[i] - b[i]), 1e-9);
}

TEST(NeighbourList, SpringOfASlidingPairSurvivesRebuildsAndChangesOfSides) {
  // Two grains orbit each other in stuck contact while a third races past and forces rebuilds.
  const double step = stiff.collision_time(0.5) / 50.0;
  InitialState initial;
  initial.position = {{2.0, 2.0, 2.0}, {2.99, 2.0, 2.0}};
  initial.velocity = {{0.0, 0.05, 0.0}, {0.0, -0.05, 0.0}};
  auto setup = free_space(step);
  setup.box.period = {8.0, 8.0, 8.0};
  Simulation alone(rough(stiff, 0.5), setup, initial);
  initial.position.push_back({6.0, 6.0, 6.0});
  initial.velocity.push_back({300.0, 200.0, 0.0});
  Simulation disturbed(rough(stiff, 0.5), setup, initial);
  for (int k = 0; k < 20; ++k) {
    alone.step();
    disturbed.step();
  }
  EXPECT_GT(disturbed.rebuilds(), 2 * alone.rebuilds());
  for (std::uint32_t id : {0u, 1u}) {
    const auto velocity = [&](const auto& simulation) {
      std::size_t i = 0;
      while (simulation.particles().id[i] != id) ++i;
      return simulation.velocity(i);
    };
    EXPECT_LT(length(velocity(alone) - velocity(disturbed)), 1e-12);
  }
}

}  // namespace
}  // namespace grainlaw::dem
