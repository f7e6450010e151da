// What validate() refuses, by name, and what it lets pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/scene.h"
#include "tests/dem/scene_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

TEST(Scene, EveryBadNumberOfAChuteIsRefusedByName) {
  using C = Chute;
  expect_refusals(
      small_chute(),
      {spoilt<C>("inclination = -5 degrees: must lie in [0, 90); a negative tilt flows in -x",
                 [](C& c) { c.inclination = radians(-5.0); }),
       spoilt<C>("inclination = 90", [](C& c) { c.inclination = radians(90.0); }),
       spoilt<C>("grains = 0: at least 1 must flow", [](C& c) { c.grains = 0; }),
       spoilt<C>("grains = 1000001", [](C& c) { c.grains = 1'000'001; }),
       spoilt<C>("length = 2.9: the period must be at least 3 (3 of", [](C& c) { c.length = 2.9; }),
       spoilt<C>("width = nan", [](C& c) { c.width = NAN; }),
       spoilt<C>("base thickness = 0.5", [](C& c) { c.base = BumpyBase{.thickness = 0.5}; }),
       spoilt<C>("lattice spacing = 1.71", [](C& c) { c.base = LatticeBase{.spacing = 1.71}; }),
       spoilt<C>("length x width = 10000 x 100: 55 moving grains and 3910437 to cut base",
                 [](C& c) {
                   c.length = 1e4;
                   c.width = 100.0;
                 }),
       {"normal stiffness = -1", [](Scene& s) { s.normal = Hooke{.stiffness = -1.0}; }},
       {"frame_interval = 0.05", [](Scene& s) { s.measurement.frame_interval = 0.05; }},
       {"averaging_time = 3", [](Scene& s) { s.measurement.averaging_time = 3.0; }},
       {"time_limit = 100", [](Scene& s) { s.measurement.time_limit = 100.0; }},
       {"bin_width = 0", [](Scene& s) { s.measurement.bin_width = 0.0; }},
       {"bin_width = 1.1: at most 1.053", [](Scene& s) { s.measurement.bin_width = 1.1; }},
       {"time step = 1e-10: 1e+13 steps", [](Scene& s) { s.time_step = 1e-10; }},
       {"max_overlap = 1.5", [](Scene& s) { s.max_overlap = 1.5; }},
       {"grain mass = inf", [](Scene& s) { s.grains.mass = infinite; }},
       {"size_ratio = 0.5", [](Scene& s) { s.grains.size_ratio = 0.5; }},
       {"size_ratio = 21", [](Scene& s) { s.grains.size_ratio = 21.0; }},
       {"time_step = nan", [](Scene& s) { s.time_step = NAN; }}});
}

TEST(Scene, EveryBadNumberOfALawIsRefusedByName) {
  const auto well = [](double strength, double width) {
    return [=](Scene& s) { s.cohesion = GaussianWell{strength, width}; };
  };
  const auto adhesion = [](double force, double slope) {
    return [=](Scene& s) { s.cohesion = ReversibleAdhesion{force, slope}; };
  };
  const auto bridge = [](double tension, double degrees, double volume) {
    return [=](Scene& s) { s.cohesion = LiquidBridge{tension, radians(degrees), volume}; };
  };
  expect_refusals(
      small_chute(),
      {{"normal damping is",
        [](Scene& s) {
          s.normal = Hooke{2e4, 300.0};
        }},
       {"normal damping is",
        [](Scene& s) {
          s.normal = Hertz{2e4, NAN};
        }},
       {"friction coefficient = -0.5",
        [](Scene& s) {
          s.friction = Sliding{-0.5, 1e4, 0.0};
        }},
       {"friction coefficient = 0: leave",
        [](Scene& s) {
          s.friction = Sliding{0.0, 1e4, 0.0};
        }},
       {"tangential stiffness = 0",
        [](Scene& s) {
          s.friction = Sliding{0.5, 0.0, 0.0};
        }},
       {"tangential damping is",
        [](Scene& s) {
          s.friction = Sliding{0.5, 1e4, 200.0};
        }},
       {"static_coefficient = 0.5: must be finite and above coefficient = 0.5",
        [](Scene& s) {
          s.friction = StickSlip{0.5, 0.5, 1e4, 0.0};
        }},
       {"strength = 0: leave [contact.cohesion] out", well(0.0, 0.01)},
       {"width of the well = 0", well(0.5, 0.0)},
       {"the attraction reaches 0.6 beyond contact: at most 0.5", well(0.5, 0.3)},
       {"largest_force = 0: leave", adhesion(0.0, 2e4)},
       {"slope of the attraction = -1", adhesion(1.0, -1.0)},
       {"the attraction reaches 1 beyond", adhesion(1.0, 1.0)},
       {"the attraction 4000 pulls two grains at rest 0.2 into each", adhesion(4000.0, 2e4)},
       {"surface_tension = 0: leave", bridge(0.0, 20.0, 1e-3)},
       {"contact_angle = 90 degrees: must lie in [0, 90)", bridge(1.0, 90.0, 1e-3)},
       {"volume of a bridge = 0", bridge(1.0, 20.0, 0.0)},
       {"the attraction reaches 1.175 beyond", bridge(1.0, 20.0, 1.0)}});
}

TEST(Scene, EveryBadNumberOfTheOtherGeometriesIsRefusedByName) {
  using S = SimpleShear;
  expect_refusals(
      small_shear(),
      {spoilt<S>("shear_rate = 0", [](S& s) { s.shear_rate = 0.0; }),
       spoilt<S>("pressure = -1", [](S& s) { s.pressure = -1.0; }),
       spoilt<S>("grains = 0: at least 1 must shear", [](S& s) { s.grains = 0; }),
       spoilt<S>("length = 2.05881: the period", [](S& s) { s.grains = 10; }),
       spoilt<S>("volume_fraction = 0.7 at the start", [](S& s) { s.volume_fraction = 0.7; }),
       spoilt<S>("height = 2: the period",
                 [](S& s) {
                   s.size = {5.0, 2.0, 5.0};
                 }),
       spoilt<S>("volume_fraction = 0.8378 at", [](S& s) {
         s.size = {5.0, 5.0, 5.0};
       })});
  using P = PlaneShear;
  expect_refusals(small_plane(),
                  {spoilt<P>("velocity = 0", [](P& p) { p.velocity = 0.0; }),
                   spoilt<P>("load = 0", [](P& p) { p.load = 0.0; }),
                   spoilt<P>("gravity = -1", [](P& p) { p.gravity = -1.0; }),
                   spoilt<P>("a flat wall", [](P& p) { p.wall = FlatBase{}; }),
                   spoilt<P>("bin_width = 1: at most 0.9404, a third of the distance of the walls",
                             [](P& p) { p.grains = 200; })});
  using B = BodyForceBox;
  expect_refusals(small_box(),
                  {spoilt<B>("amplitude = 0", [](B& b) { b.amplitude = 0.0; }),
                   spoilt<B>("pressure = 0", [](B& b) { b.pressure = 0.0; }),
                   spoilt<B>("grains = 200: fill 2.821", [](B& b) { b.grains = 200; })});
  using C = SplitBottom;
  expect_refusals(
      small_cell(),
      {spoilt<C>("inner_radius = 0", [](C& c) { c.inner_radius = 0.0; }),
       spoilt<C>("split_radius = 5: must be above", [](C& c) { c.split_radius = 5.0; }),
       spoilt<C>("outer_radius = 38: must be finite", [](C& c) { c.outer_radius = 38.0; }),
       spoilt<C>("wedge = 50 degrees: must be a full turn", [](C& c) { c.wedge = radians(50); }),
       spoilt<C>("wedge = 120 degrees: must be a full", [](C& c) { c.wedge = radians(120); }),
       spoilt<C>("wedge = 18 degrees: 2.099 wide at the", [](C& c) { c.wedge = radians(18); }),
       spoilt<C>("rotation_rate = 0", [](C& c) { c.rotation_rate = 0.0; }),
       spoilt<C>("base thickness = 0.5", [](C& c) { c.base_thickness = 0.5; })});
}

TEST(Scene, LoadsThatPressGrainsIntoEachOtherByTheirSizeAreRefused) {
  Scene plane = small_plane();
  std::get<PlaneShear>(plane.geometry).load = 1e300;
  EXPECT_EQ(refusal(plane).substr(0, 12), "load = 1e+30");
  Scene box = small_box();
  std::get<BodyForceBox>(box.geometry).pressure = soft.stiffness;
  EXPECT_EQ(refusal(box).substr(0, 10), "pressure =");
  std::get<BodyForceBox>(box.geometry).pressure = 0.5 * soft.stiffness;
  EXPECT_EQ(refusal(box), "");
}

TEST(Scene, RefusalsNameSectionAndKeyOfTheSceneFile) {
  Scene scene = small_chute();
  chute(scene).base = BumpyBase{.thickness = 0.5};
  try {
    validate(scene);
    FAIL() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.section, "geometry.base");
    EXPECT_EQ(error.key, "thickness");
  }
}

TEST(Scene, ExtremeGrainsAreAccepted) {
  for (const double stiffness : {2e3, 2e9}) {
    for (const double restitution : {0.1, 0.999}) {
      Scene scene = small_chute();
      scene.normal = Hooke{stiffness, damping_for(restitution, stiffness, 0.5)};
      scene.friction = Sliding{10.0, 2.0 / 7.0 * stiffness, 0.0};
      EXPECT_EQ(refusal(scene), "");
    }
  }
  Scene cohesive = small_chute();
  cohesive.normal = stiff;
  cohesive.cohesion = GaussianWell{.strength = 10.0, .width = 0.01};
  EXPECT_EQ(refusal(cohesive), "");
  Scene broad = small_chute();
  broad.grains.size_ratio = 10.0;
  chute(broad).length = chute(broad).width = 6.0;
  chute(broad).grains = 300;
  EXPECT_EQ(refusal(broad), "");
}

TEST(Scene, SlowAndFastShearAreAccepted) {
  const double pressure = 2.0;  // p* = 1e-4 with k_n = 2e4
  for (const double inertial_number : {1e-5, 10.0}) {
    Scene scene = small_shear();
    SimpleShear& shear = std::get<SimpleShear>(scene.geometry);
    shear.pressure = pressure;
    shear.shear_rate = inertial_number * std::sqrt(pressure / scene.grains.density());
    scene.measurement.sample_interval = 0.01 / shear.shear_rate;
    scene.measurement.frame_interval = 0.2 / shear.shear_rate;
    scene.measurement.averaging_time = 20.0 / shear.shear_rate;
    scene.measurement.time_limit = 100.0 / shear.shear_rate;
    scene.cohesion = ReversibleAdhesion{.largest_force = 50.0 * pressure, .slope = 2e4};  // Bo = 50
    EXPECT_EQ(refusal(scene), "");
  }
}

TEST(Scene, OneGrainOrTwoAreAcceptedWhereTheyHaveRoom) {
  for (const int grains : {1, 2}) {
    Scene pair = small_shear();
    std::get<SimpleShear>(pair.geometry).grains = grains;
    std::get<SimpleShear>(pair.geometry).size = {3.0, 3.0, 3.0};
    EXPECT_EQ(refusal(pair), "");
    Scene layer = small_chute();
    chute(layer).grains = grains;
    EXPECT_NE(refusal(layer).find("take more grains"), std::string::npos) << refusal(layer);
  }
}

TEST(Scene, PeriodsHoldTheLargestGrainAndItsAttraction) {
  Scene scene = small_chute();
  chute(scene).length = 3.0;
  EXPECT_EQ(refusal(scene), "");
  scene.cohesion = ReversibleAdhesion{.largest_force = 100.0, .slope = 250.0};
  // 2.2 reaches of 1 + 0.4.
  EXPECT_TRUE(refusal(scene).starts_with("length = 3: the period must be at least 3.08"));
  scene.cohesion = Cohesionless{};
  scene.grains.size_ratio = 3.0;
  EXPECT_TRUE(refusal(scene).starts_with("length = 3: the period must be at least 4.5 (3 of"));
}

TEST(Scene, TheHeaviestGrainsBoundTheDamping) {
  Scene scene = small_chute();
  const double critical = 2.0 * std::sqrt(soft.stiffness);  // on a glued grain
  scene.normal = Hooke{soft.stiffness, 0.99 * critical};
  EXPECT_EQ(refusal(scene), "");
  scene.grains.size_ratio = 1.5;  // the largest weighs 1.2^3 = 1.728
  EXPECT_TRUE(refusal(scene).starts_with("normal damping"));
  scene.geometry = small_shear().geometry;  // without walls, half of it
  EXPECT_EQ(refusal(scene), "");
}

TEST(Scene, BinsOfALayerThreeOfThemDeepAreAccepted) {
  Scene scene = small_chute();
  scene.measurement.bin_width = nominal_depth(scene.grains, chute(scene)) / 3.0;
  EXPECT_NO_THROW(validate(scene));
}

/// A glued grain under one that moves.
Scene given_start() {
  Scene scene = small_chute();
  scene.start = {{.position = {1.0, 1.0, -0.5}, .frozen = true}};
  for (int k = 0; k < 55; ++k) {
    scene.start.push_back({
        .position = {1.0, 1.0, 1.0 + k},
    });
  }
  return scene;
}

TEST(Scene, GrainsOfAStartAreCountedAndChecked) {
  EXPECT_EQ(grains(given_start()), 55);
  expect_refusals(
      given_start(),
      {{"grain 2 of the start: all its numbers", [](Scene& s) { s.start[1].position.x = NAN; }},
       {"grain 3 of the start: diameter = 1.5", [](Scene& s) { s.start[2].diameter = 1.5; }},
       {"grains = 54: the start has 55 that move", [](Scene& s) { chute(s).grains = 54; }},
       {"the start has no frozen grains: they are the base",
        [](Scene& s) { s.start.erase(s.start.begin()); }},
       {"the start has 1 frozen grains: a simple_shear has no base", [](Scene& s) {
          s.geometry = SimpleShear{.shear_rate = 1.0, .grains = 55, .size = {9, 9, 9}};
        }}});
  Scene flat = given_start();
  flat.start.erase(flat.start.begin());
  chute(flat).base = FlatBase{};
  EXPECT_EQ(refusal(flat), "");
}

TEST(Scene, AStartProfileIsThatOfAChuteAndRises) {
  Scene scene = small_chute();
  scene.start_profile = {{0.0, 0.0}, {1.0, 0.3}, {3.0, 0.5}};
  EXPECT_EQ(refusal(scene), "");
  scene.start_profile[2].z = 1.0;
  EXPECT_EQ(refusal(scene), "row 3 of the start profile: z = 1 is not above the row before it");
  scene.start_profile[2].z = infinite;
  EXPECT_EQ(refusal(scene), "row 3 of the start profile: its numbers must be finite");
  Scene box = small_shear();
  box.start_profile = {{0.0, 0.0}};
  EXPECT_EQ(refusal(box), "a start profile is that of a chute, not of a simple_shear");
}

}  // namespace
}  // namespace grainlaw::dem
