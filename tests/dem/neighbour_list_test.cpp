#include "dem/neighbour_list.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "dem/scene.h"
#include "dem/stand_ins.h"
#include "tests/dem/pair_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// Where the partner of a pair was seen: its shift by periods, or the turns of its wedge.
using Sight = std::array<int, 3>;
/// Every pair by its numbers (the lower one first) and how the second is seen from the first.
using PairSet = std::multiset<std::tuple<std::uint32_t, std::uint32_t, Sight>>;

std::tuple<std::uint32_t, std::uint32_t, Sight> ordered(std::uint32_t i,
                                                        std::uint32_t j,
                                                        Sight sight) {
  if (i <= j) return {i, j, sight};
  return {j, i, {-sight[0], -sight[1], -sight[2]}};
}

/// Grains anywhere in the box, 0 to `extent` along open axes; some are frozen.
struct Cloud {
  Box box;
  Vec3 extent;
  std::size_t mobile = 80;
  std::size_t frozen = 20;
  double size_ratio = 1.0;
};

InitialState grains_of(const Cloud& cloud, Random& random) {
  InitialState initial;
  initial.box = cloud.box;
  for (std::size_t k = 0; k < cloud.mobile + cloud.frozen; ++k) {
    InitialGrain grain;
    const auto along = [&](double period, double extent) {
      return random.between(0.0, period > 0.0 ? period : extent);
    };
    grain.position = {along(cloud.box.period.x, cloud.extent.x),
                      along(cloud.box.period.y, cloud.extent.y),
                      along(cloud.box.period.z, cloud.extent.z)};
    if (cloud.box.wedge > 0.0) {
      const double r = random.between(4.5, cloud.extent.x);
      const double angle = random.between(0.0, cloud.box.wedge);
      grain.position = {r * std::cos(angle), r * std::sin(angle), grain.position.z};
    }
    grain.diameter = 2.0 / (1.0 + cloud.size_ratio) * random.between(1.0, cloud.size_ratio);
    grain.body = k < cloud.mobile ? Body::none : Body::base;
    initial.grains.push_back(grain);
  }
  return initial;
}

/// All pairs closer than their reach, every image tried.
PairSet all_pairs(const Particles& particles, const Box& box, const NeighbourList& list) {
  PairSet pairs;
  const auto sights = [](bool repeats) { return repeats ? 2 : 0; };
  const int nx = sights(box.period.x > 0.0), ny = sights(box.period.y > 0.0),
            nz = sights(box.period.z > 0.0), turns = box.wedge > 0.0 ? 1 : 0;
  for (std::uint32_t i = 0; i < particles.real; ++i) {
    for (std::uint32_t j = i + 1; j < particles.real; ++j) {
      if (i >= particles.mobile) continue;
      const GrainState& a = particles.state[i];
      const GrainState& b = particles.state[j];
      const auto look = [&](const Vec3& there, const Sight& sight) {
        if (length(a.position - there) < list.reach(a.radius + b.radius)) {
          pairs.insert(ordered(particles.id[i], particles.id[j], sight));
        }
      };
      for (int t = -turns; t <= turns; ++t) {
        if (box.wedge > 0.0) look(turned(b.position, t * box.wedge), {t, 0, 0});
      }
      for (int x = -nx; x <= nx && box.wedge == 0.0; ++x) {
        for (int y = -ny; y <= ny; ++y) {
          for (int z = -nz; z <= nz; ++z) {
            const Vec3 shift{x * box.period.x + y * box.offset, y * box.period.y, z * box.period.z};
            look(b.position + shift, {x, y, z});
          }
        }
      }
    }
  }
  return pairs;
}

PairSet listed_pairs(const NeighbourList& list,
                     const Particles& particles,
                     const Box& box,
                     const StandIns& stand_ins) {
  PairSet pairs;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    for (auto k = list.row_begin(i); k < list.row_begin(i + 1); ++k) {
      EXPECT_EQ(list.first()[k], i);
      const Partner partner = list.partners()[k];
      const std::uint32_t j = partner.grain();
      const int image = static_cast<int>(partner.image());
      Sight sight{image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1};
      if (j >= particles.real) {
        const double angle = stand_ins.image_angle.at(j - particles.real);
        sight = {static_cast<int>(std::lround(angle / box.wedge)), 0, 0};
      }
      pairs.insert(ordered(particles.id[i], particles.id[j], sight));
    }
  }
  return pairs;
}

/// Number of pairs.
std::size_t expect_complete(const Cloud& cloud, double range, double skin, Random& random) {
  Particles particles = make_particles(grains_of(cloud, random), unit_density, false);
  wrap(particles, cloud.box);
  NeighbourList list(range, skin);
  reorder(particles, list.cell_order(particles, cloud.box));
  StandIns stand_ins;
  stand_ins.list(particles, cloud.box, {}, range + skin);
  stand_ins.append(particles, {});
  list.build(particles, cloud.box);
  const PairSet expected = all_pairs(particles, cloud.box, list);
  EXPECT_EQ(listed_pairs(list, particles, cloud.box, stand_ins), expected);
  EXPECT_EQ(list.pairs(), expected.size());
  return expected.size();
}

TEST(NeighbourList, IsTheListOfAllPairsInPeriodicAndOpenBoxes) {
  Random random(11);
  const std::array<Vec3, 7> periods{Vec3{8.0, 5.5, 0.0},
                                    {5.0, 6.5, 4.0},
                                    {3.0, 3.0, 14.0},
                                    {3.0, 3.0, 3.0},
                                    {0.0, 0.0, 0.0},
                                    {0.0, 4.0, 0.0},
                                    {0.0, 0.0, 3.5}};
  for (const Vec3& period : periods) {
    SCOPED_TRACE(testing::Message() << period.x << ' ' << period.y << ' ' << period.z);
    const Cloud cloud{.box = {.period = period}, .extent = {6.0, 6.0, 6.0}};
    EXPECT_GT(expect_complete(cloud, 0.0, 0.25, random), 100u);
  }
}

TEST(NeighbourList, FollowsLeesEdwardsImagesAtAnyOffset) {
  Random random(12);
  const std::array<Vec3, 4> periods{
      Vec3{6.0, 6.0, 6.0}, {3.0, 3.0, 3.0}, {3.3, 8.0, 5.0}, {9.0, 3.0, 3.0}};
  for (const Vec3& period : periods) {
    for (int n = 0; n < 40; ++n) {
      Cloud cloud{.box = {.period = period}, .extent = {}};
      cloud.box.offset = (n < 2 ? n - 0.5 : random.between(-0.5, 0.5)) * period.x;
      SCOPED_TRACE(testing::Message() << period.x << ", offset " << cloud.box.offset);
      expect_complete(cloud, 0.0, 0.25, random);
    }
  }
}

TEST(NeighbourList, KeepsGrainsOnTheFacesOfASmallShearedBox) {
  // Rounding may leave a grain on the upper face itself; the offset may be half a period.
  for (const double offset : {-1.5, 1.5}) {
    InitialState initial;
    initial.box = {.period = {3.0, 3.0, 3.0}, .offset = offset};
    initial.grains = {{.position = {3.0, 0.1, 2.0}},
                      {.position = {1.5, 2.9, 2.0}},
                      {.position = {0.1, 2.8, 2.0}}};
    const Particles particles = make_particles(initial, unit_density, false);
    NeighbourList list(0.0, 0.25);
    list.build(particles, initial.box);
    EXPECT_EQ(listed_pairs(list, particles, initial.box, {}),
              all_pairs(particles, initial.box, list));
  }
}

TEST(NeighbourList, ServesGrainsOfAllSizesAtOnce) {
  Random random(13);
  for (const double ratio : {2.0, 10.0, 20.0}) {
    const double least = 3.0 * Grains{.size_ratio = ratio}.largest();
    for (const double offset : {0.0, 1.3}) {
      Cloud cloud{.box = {.period = {least, least, least}, .offset = offset}, .extent = {}};
      cloud.size_ratio = ratio;
      EXPECT_GT(expect_complete(cloud, 0.02, 0.25, random), 100u);
    }
  }
}

TEST(NeighbourList, SeesPairsAcrossTheFacesOfAWedgeOnce) {
  Random random(14);
  for (const int sections : {4, 6, 12}) {
    for (const double ratio : {1.0, 3.0}) {
      Cloud cloud{.box = {.wedge = 2.0 * std::numbers::pi / sections}, .extent = {9.0, 0.0, 3.0}};
      cloud.size_ratio = ratio;
      cloud.frozen = 40;
      EXPECT_GT(expect_complete(cloud, 0.02, 0.25, random), 100u);
    }
  }
}

TEST(NeighbourList, OfNoGrainOrOneOrTwoIsRight) {
  Random random(15);
  for (const std::size_t grains : {0, 1, 2}) {
    for (const double period : {0.0, 3.0}) {
      Cloud cloud{.box = {.period = {period, period, period}}, .extent = {2.0, 2.0, 2.0}};
      cloud.mobile = grains;
      cloud.frozen = 0;
      for (int n = 0; n < 20; ++n) expect_complete(cloud, 0.0, 0.25, random);
    }
  }
}

TEST(NeighbourList, HoldsTheFeetOfGrainsNearWalls) {
  Random random(16);
  Particles particles = make_particles(
      grains_of({.box = {}, .extent = {4.0, 4.0, 4.0}}, random), unit_density, false);
  const std::vector<Wall> walls{{.shape = Plane{.point = {}, .normal = {0.0, 0.0, 1.0}}},
                                {.shape = Plane{.point = {}, .normal = {0.0, 1.0, 0.0}}},
                                {.shape = Cylinder{.radius = 7.0}}};
  NeighbourList list(0.02, 0.25);
  reorder(particles, list.cell_order(particles, {}));
  StandIns stand_ins;
  stand_ins.list(particles, {}, walls, 0.27);
  stand_ins.append(particles, walls);
  list.build(particles, {}, stand_ins.foot_of);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> listed;
  for (std::size_t k = 0; k < list.pairs(); ++k) {
    const std::uint32_t j = list.partners()[k].grain();
    if (j >= particles.real) ++listed[{list.first()[k], particles.id[j] - first_wall_id}];
  }
  std::size_t near = 0;
  for (std::uint32_t i = 0; i < particles.mobile; ++i) {
    for (std::uint32_t w = 0; w < walls.size(); ++w) {
      const GrainState& grain = particles.state[i];
      if (walls[w].distance(grain.position) >= grain.radius + 0.27) continue;
      ++near;
      EXPECT_EQ((listed[{i, w}]), 1);
    }
  }
  EXPECT_GT(near, 20u);
  std::size_t feet = 0;
  for (const auto& [pair, times] : listed) feet += static_cast<std::size_t>(times);
  EXPECT_EQ(feet, near);
}

}  // namespace
}  // namespace grainlaw::dem
