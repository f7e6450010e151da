#include "dem/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/dem/scene_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(Scene, ContactTimesOfNormalAndTangentialSpringAreEqualAtTwoSevenths) {
  Scene scene = small_chute();
  const double both = shortest_contact_time(scene);
  EXPECT_NEAR(both, std::numbers::pi / std::sqrt(2.0 * soft.stiffness), 1e-15);
  scene.friction = Frictionless{};
  EXPECT_NEAR(shortest_contact_time(scene), both, 1e-15);
  scene.friction = Sliding{.coefficient = 0.5, .stiffness = soft.stiffness, .damping = 0.0};
  EXPECT_NEAR(shortest_contact_time(scene), both * std::sqrt(2.0 / 7.0), 1e-15);
  scene.friction = StickSlip{0.6, 0.5, soft.stiffness, 0.0};
  EXPECT_NEAR(shortest_contact_time(scene), both * std::sqrt(2.0 / 7.0), 1e-15);
  EXPECT_DOUBLE_EQ(time_step(scene), shortest_contact_time(scene) / 50.0);
}

TEST(Scene, TheSmallestGrainsHaveTheShortestContact) {
  Scene scene = small_chute();
  const double equal = shortest_contact_time(scene);
  scene.grains.size_ratio = 3.0;  // the smallest has half the diameter, an eighth of the mass
  EXPECT_NEAR(shortest_contact_time(scene), equal / std::sqrt(8.0), equal * few_roundings);
}

TEST(Scene, ASteepAttractionShortensTheContact) {
  Scene scene = small_chute();
  const double bare = shortest_contact_time(scene);
  scene.cohesion = GaussianWell{.strength = 0.6, .width = 0.01};  // 2A/l^2 = 1.2e4 below k_n
  EXPECT_EQ(shortest_contact_time(scene), bare);
  scene.normal = Hooke{.stiffness = 2e3, .damping = 5.0};  // six times softer (Brewster, A = 0.6)
  scene.friction = Frictionless{};
  const double slope = std::numbers::pi / std::sqrt(2.0 * 1.2e4);
  EXPECT_NEAR(shortest_contact_time(scene), slope, slope * few_roundings);
}

TEST(Scene, HertzContactsAreTimedAtTheirDeepestOverlap) {
  Scene scene = small_chute();
  scene.normal = Hertz{.stiffness = 2e4, .damping = 10.0};
  scene.friction = Frictionless{};
  // Tangent 3/2 k sqrt(x) at x = max_overlap / 2 of the diameter.
  const double tangent = 1.5 * 2e4 * std::sqrt(0.15);
  const double normal = std::numbers::pi * std::sqrt(0.5 / tangent);
  EXPECT_NEAR(shortest_contact_time(scene), normal, normal * few_roundings);
  scene.friction = Sliding{.coefficient = 0.5, .stiffness = 2e4, .damping = 0.0};
  const double tangential = std::numbers::pi * std::sqrt(1.0 / 7.0 / (2e4 * std::sqrt(0.15)));
  EXPECT_NEAR(shortest_contact_time(scene), tangential, tangential * few_roundings);
}

TEST(Scene, UnstableStepIsRefusedWithBoundAndDefaultUnlessAllowed) {
  Scene scene = small_chute();
  scene.normal = stiff;
  scene.friction = Frictionless{};
  scene.time_step = 1e-3;
  try {
    validate(scene);
    FAIL() << "accepted";
  } catch (const StepRefused& error) {
    EXPECT_STREQ(error.what(),
                 "time_step = 0.001 exceeds 1/15 of the shortest contact time (0.00497 for "
                 "stiffness = 200000): at most 0.000331; the default would be 9.93e-05");
  }
  scene.allow_unstable_step = true;
  EXPECT_NO_THROW(validate(scene));
  scene.allow_unstable_step = false;
  scene.time_step = shortest_contact_time(scene) / 15.01;
  EXPECT_NO_THROW(validate(scene));
}

TEST(Scene, MassAndDepthOfMixedGrainsFollowTheirMeanMass) {
  const Chute layer{.length = 8.0, .width = 8.0, .grains = 1000};
  const Grains mixed{.size_ratio = 3.0};  // <D^3> = 5/4 d^3
  EXPECT_NEAR(mass_per_area(mixed, layer), 1.25 * 1000.0 / 64.0, 20.0 * few_roundings);
  EXPECT_NEAR(
      nominal_depth(mixed, layer), 1.25 * nominal_depth(Grains{}, layer), 30.0 * few_roundings);
}

TEST(Scene, BoxesHoldTheirGrainsAtTheirVolumeFraction) {
  const Grains grains{.size_ratio = 2.0};
  const double volume = 500.0 * grains.mean_mass() / grains.density();
  const SimpleShear shear{.grains = 500, .volume_fraction = 0.6};
  const Vec3 size = start_size(grains, shear);
  EXPECT_NEAR(volume / (size.x * size.y * size.z), 0.6, few_roundings);
  const PlaneShear plane{.grains = 500};
  EXPECT_NEAR(volume / (64.0 * start_gap(grains, plane)), plane.volume_fraction, few_roundings);
  const BodyForceBox box{.grains = 500};
  EXPECT_NEAR(volume / (64.0 * start_height(grains, box)), box.volume_fraction, few_roundings);
}

TEST(Scene, TwelveWedgesAreTheRing) {
  const SplitBottom cell;
  const double ring = std::numbers::pi * (cell.outer_radius * cell.outer_radius -
                                          cell.inner_radius * cell.inner_radius);
  EXPECT_NEAR(12.0 * floor_area(cell), ring, ring * few_roundings);
}

bool has(const std::vector<std::string>& lines, std::string_view text) {
  return std::ranges::any_of(lines, [&](auto& l) { return l.find(text) != std::string::npos; });
}

TEST(Scene, SummaryNamesWhatIsLeftOut) {
  Scene scene = small_chute();
  scene.friction = Frictionless{};
  const SceneSummary summary = summarise(scene);
  EXPECT_TRUE(has(summary.left_out, "no cohesion: no force beyond contact"));
  EXPECT_TRUE(has(summary.left_out, "no rotation, no history"));
  EXPECT_TRUE(has(summary.left_out, "equal grains"));
  EXPECT_TRUE(has(summary.left_out, "no side walls"));
  EXPECT_FALSE(has(summary.used, "friction"));
  EXPECT_TRUE(has(summarise(small_chute()).used, "friction: coefficient 0.5"));
  EXPECT_TRUE(has(summarise(small_chute()).left_out, "no rolling or torsion"));
}

TEST(Scene, SummaryNamesWhatIsUsed) {
  Scene scene = small_chute();
  scene.normal = Hertz{.stiffness = 2e4, .damping = 10.0, .clip_attraction = true};
  scene.cohesion = GaussianWell{.strength = 0.6, .width = 0.01};
  scene.friction = StickSlip{0.6, 0.5, 1e4, 1.0};
  scene.grains.size_ratio = 3.0;
  chute(scene).sidewalls = Sidewalls{.frictional = false};
  const SceneSummary summary = summarise(scene);
  for (const char* words : {"Hertz",
                            "never negative",
                            "Gaussian well, strength 0.6",
                            "bounded by the total normal force",
                            "coefficients 0.6 static, 0.5 dynamic",
                            "tangential damping rate 1",
                            "from 0.5 to 1.5",
                            "side walls: flat, smooth",
                            "chute: 55 grains"}) {
    EXPECT_TRUE(has(summary.used, words)) << words;
  }
  EXPECT_FALSE(has(summary.left_out, "equal grains"));
}

TEST(Scene, EveryGeometryIsNamedInItsSummary) {
  for (const auto& [scene, kind_of, words] :
       {std::tuple{small_shear(), "simple_shear", "simple shear: 200 grains in 5.58846 x"},
        std::tuple{small_plane(), "plane_shear", "plane shear: 500 grains"},
        std::tuple{small_box(), "body_force_box", "body force: 500 grains"},
        std::tuple{small_cell(), "split_bottom", "2000 grains in a wedge of 30 degrees"}}) {
    EXPECT_EQ(kind(scene.geometry), kind_of);
    EXPECT_TRUE(has(summarise(scene).used, words)) << words << "\n" << summarise(scene).used[2];
  }
}

TEST(Scene, RecipesOfDifferentBasesDiffer) {
  const std::vector<Base> bases{
      BumpyBase{}, LatticeBase{}, FlatBase{}, FlatBase{.frictional = false}, BumpyBase{2.0, 0.585}};
  for (std::size_t i = 0; i < bases.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(recipe(bases[i]), recipe(bases[j]));
  }
}

}  // namespace
}  // namespace grainlaw::dem
