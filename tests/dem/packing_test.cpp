#include "dem/packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace grainlaw::dem {
namespace {

/// Largest overlap [mean diameter of the pair] that involves a mobile grain, every pair looked at;
/// image(p, k) is the k-th of `images` images of a point, the point itself included.
constexpr double rounding = 1e-12;  // of places in a box of some 10 d

template <class Image>
double worst_overlap(const std::vector<InitialGrain>& grains, int images, Image image) {
  double worst = 0.0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (grains[i].body != Body::none && grains[j].body != Body::none) continue;
      const double touching = 0.5 * (grains[i].diameter + grains[j].diameter);
      for (int k = 0; k < images; ++k) {
        const double distance = length(grains[i].position - image(grains[j].position, k));
        worst = std::max(worst, (touching - distance) / touching);
      }
    }
  }
  return worst;
}

double worst_overlap(const InitialState& state) {
  const auto shifts = state.box.image_shifts();
  return worst_overlap(
      state.grains, 27, [&](const Vec3& p, int k) { return p + shifts[k].position; });
}

double worst_overlap_in_sector(const std::vector<InitialGrain>& grains, double wedge) {
  return worst_overlap(grains, 3, [&](const Vec3& p, int k) { return turned(p, (k - 1) * wedge); });
}

std::vector<InitialGrain> part(const InitialState& state, Body body) {
  std::vector<InitialGrain> result;
  for (const InitialGrain& grain : state.grains) {
    if (grain.body == body) result.push_back(grain);
  }
  return result;
}

double solid_volume(const std::vector<InitialGrain>& grains) {
  double sum = 0.0;
  for (const InitialGrain& grain : grains) {
    sum += std::numbers::pi / 6.0 * std::pow(grain.diameter, 3);
  }
  return sum;
}

double highest_centre(const std::vector<InitialGrain>& grains) {
  return std::max_element(grains.begin(),
                          grains.end(),
                          [](const InitialGrain& a, const InitialGrain& b) {
                            return a.position.z < b.position.z;
                          })
      ->position.z;
}

double lowest_centre(const std::vector<InitialGrain>& grains) {
  return std::min_element(grains.begin(),
                          grains.end(),
                          [](const InitialGrain& a, const InitialGrain& b) {
                            return a.position.z < b.position.z;
                          })
      ->position.z;
}

std::vector<double> sorted_diameters(const std::vector<InitialGrain>& grains) {
  std::vector<double> result;
  for (const InitialGrain& grain : grains) result.push_back(grain.diameter);
  std::sort(result.begin(), result.end());
  return result;
}

bool covers(double period, double value) {
  return period == 0.0 || (value >= 0.0 && value < period);
}

bool inside_periods(const InitialState& state) {
  const Vec3& period = state.box.period;
  return std::all_of(state.grains.begin(), state.grains.end(), [&](const InitialGrain& g) {
    return covers(period.x, g.position.x) && covers(period.y, g.position.y) &&
           covers(period.z, g.position.z);
  });
}

bool at_rest(const std::vector<InitialGrain>& grains) {
  return std::all_of(grains.begin(), grains.end(), [](const InitialGrain& g) {
    return g.velocity == Vec3{} && g.rotation == Vec3{};
  });
}

Scene scene_of(Geometry geometry, double size_ratio = 1.0) {
  Scene scene;
  scene.geometry = std::move(geometry);
  scene.grains.size_ratio = size_ratio;
  scene.seed = 11;
  return scene;
}

Chute chute(int grains, Base base = BumpyBase{}) {
  Chute result;
  result.grains = grains;
  result.base = base;
  return result;
}

SimpleShear simple_shear(int grains) {
  SimpleShear result;
  result.shear_rate = 0.3;
  result.grains = grains;
  result.volume_fraction = 0.58;
  return result;
}

PlaneShear plane_shear(int grains) {
  PlaneShear result;
  result.velocity = 2.0;
  result.grains = grains;
  return result;
}

bool equal(const InitialState& a, const InitialState& b) {
  return std::equal(a.grains.begin(),
                    a.grains.end(),
                    b.grains.begin(),
                    b.grains.end(),
                    [](const InitialGrain& g, const InitialGrain& h) {
                      return g.position == h.position && g.diameter == h.diameter &&
                             g.body == h.body && g.velocity == h.velocity;
                    });
}

/// The packing of spheres of these diameters, as a state.
InitialState packing(const Box& box, const std::vector<double>& sizes, std::uint64_t seed) {
  InitialState state{.box = box, .grains = {}};
  const std::vector<Vec3> points = random_packing(box, sizes, seed);
  for (std::size_t k = 0; k < points.size(); ++k) {
    InitialGrain grain;
    grain.position = points[k];
    grain.diameter = sizes[k];
    state.grains.push_back(grain);
  }
  return state;
}

Box box_of(const Vec3& period) {
  Box box;
  box.period = period;
  return box;
}

Box cube_for(const std::vector<double>& sizes, double volume_fraction) {
  double sum = 0.0;
  for (const double diameter : sizes) sum += std::numbers::pi / 6.0 * std::pow(diameter, 3);
  const double edge = std::cbrt(sum / volume_fraction);
  return box_of({edge, edge, edge});
}

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

/// A small ring cell of unequal grains, 60 degrees of it.
SplitBottom small_ring() {
  return {.inner_radius = 4.0,
          .split_radius = 7.0,
          .outer_radius = 10.0,
          .wedge = std::numbers::pi / 3.0,
          .grains = 400};
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
