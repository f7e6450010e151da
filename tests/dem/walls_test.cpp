#include "dem/walls.h"

#include <gtest/gtest.h>

#include "tests/dem/pair_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

const Wall floor_wall{.shape = Plane{.point = {}, .normal = {0.0, 0.0, 1.0}}};
const Wall drum{.shape = Cylinder{.radius = 5.0, .grains_inside = true}};
const Wall pillar{.shape = Cylinder{.radius = 5.0, .grains_inside = false}};

Wall smooth(Wall wall) {
  wall.frictional = false;
  return wall;
}

/// A grain at a gap from a wall, towards which `inward` points away from it.
struct AtWall {
  Wall wall;
  Vec3 inward;
  Vec3 foot;
};
const std::array<AtWall, 3> places{AtWall{floor_wall, {0.0, 0.0, 1.0}, {0.3, -0.2, 0.0}},
                                   AtWall{drum, {-0.6, -0.8, 0.0}, {3.0, 4.0, 0.7}},
                                   AtWall{pillar, {0.6, 0.8, 0.0}, {3.0, 4.0, 0.7}}};

template <class Law>
Simulation<Law> grain_at(const Law& law,
                         const AtWall& place,
                         double gap,
                         const Vec3& velocity,
                         const Vec3& rotation,
                         double time_step,
                         double diameter = 1.2) {
  SimulationSetup setup = free_flight(time_step);
  setup.walls = {place.wall};
  InitialState one;
  one.grains = {{.position = place.foot + (0.5 * diameter + gap) * place.inward,
                 .velocity = velocity,
                 .rotation = rotation,
                 .diameter = diameter}};
  return Simulation<Law>(law, setup, one);
}

TEST(Wall, DistancesFeetAndVelocitiesAreThoseOfTheirShapes) {
  for (const AtWall& place : places) {
    const Vec3 p = place.foot + 0.7 * place.inward;
    EXPECT_NEAR(place.wall.distance(p), 0.7, 1e-15);
    EXPECT_NEAR(length(place.wall.foot(p) - place.foot), 0.0, 1e-15);
    EXPECT_EQ(place.wall.velocity(place.foot), Vec3{});
  }
  const Wall turning{.shape = Cylinder{.radius = 5.0, .rotation_rate = 0.1}};
  EXPECT_NEAR(length(turning.velocity({3.0, 4.0, 0.0}) - Vec3{-0.4, 0.3, 0.0}), 0.0, 1e-15);
}

// Rule of the engine: the same law, for a partner of radius 0 and infinite mass at the nearest
// point, at which a liquid bridge has r = 2 R.
TEST(Wall, ActsByTheLawOfAPartnerOfRadiusZeroAndInfiniteMass) {
  constexpr double step = 1e-6;
  for_each_law([&](const auto& law) {
    using Law = std::decay_t<decltype(law)>;
    SCOPED_TRACE(name(law));
    for (const AtWall& place : places) {
      for (const double gap : {-0.004, 0.004}) {
        const Vec3 velocity = -0.3 * place.inward + Vec3{0.2, -0.15, 0.5};
        const Vec3 rotation{0.5, -1.0, 2.0};
        auto grain = grain_at(law, place, gap, velocity, rotation, step);
        const bool bridged = gap < 0.0;  // by the touch at the start
        ASSERT_EQ(grain.neighbours().pairs(), 1u);
        Vec3 force;
        grain.step([&](std::uint32_t, std::uint32_t, const Vec3&, const Vec3& f) { force = f; });

        const GrainState& now = grain.particles().state[0];
        const Vec3 to_grain = now.position - place.wall.foot(now.position);
        Contact c;
        c.distance = length(to_grain);
        c.normal = 1.0 / c.distance * to_grain;
        c.overlap = 0.6 - c.distance;
        c.normal_velocity = dot(now.velocity, c.normal);
        c.reduced_mass = mass_of(1.2);
        c.radius_sum = 0.6;
        c.harmonic_radius = 1.2;
        TangentialMotion<double> motion;
        motion.surface_velocity = now.velocity - c.normal_velocity * c.normal;
        if constexpr (Law::rotates) {
          motion.surface_velocity -=
              c.distance / 0.6 * cross(grain.particles().spin[0].velocity, c.normal);
        }
        // Springs took half a step at the start, where they began, and take the whole step since.
        TangentialSpring<double> spring;
        spring.stretch = step * (gap < 0.0 ? 1.0 : 0.0) * motion.surface_velocity;
        const auto expected = contact_force(law, c, motion, 1.0, bridged, step, spring);
        const Vec3 total = expected.normal * c.normal + expected.tangential;
        // The spring of two steps, 2e-6 long, is known to the turn and acceleration in them.
        EXPECT_NEAR(length(force - total), 0.0, 1e-9 + 2e-4 * length(expected.tangential));
        EXPECT_EQ(length(force) > 0.0, gap < 0.0 || (Law::attracts && !Law::bridges));
      }
    }
  });
}

TEST(Wall, AFlatOneAndAHeavyGrainReboundAlike) {
  // Hooke does not ask for radii: a frozen grain, a plane and cylinders are the same head-on.
  const ContactLaw law{hooke, Cohesionless{}, sliding};
  const double step = hooke.contact_time(mass_of(1.2)) / 50.0;
  InitialState on_grain;
  on_grain.grains = {{.position = {0.0, 0.0, 1.11}, .velocity = {0.0, 0.0, -1.0}, .diameter = 1.2},
                     {.position = {}, .body = Body::base}};
  Simulation frozen(law, free_flight(step), on_grain);
  pass_contact(frozen);
  for (const AtWall& place : places) {
    auto grain = grain_at(law, place, 0.01, -1.0 * place.inward, {}, step);
    pass_contact(grain);
    EXPECT_NEAR(dot(velocity_of(grain, 0), place.inward), velocity_of(frozen, 0).z, 1e-10);
  }
}

TEST(Wall, RestitutionIsThatOfTheEquationOfMotionWithTheWholeMass) {
  const auto check = [](const auto& law, double duration) {
    const double step = duration / 2000.0;
    const HeadOn exact = head_on(law, mass_of(1.2), 0.6, 1.0, duration / 20'000.0);
    double sum = 0.0;
    constexpr int phases = 20;
    for (int k = 0; k < phases; ++k) {
      auto grain = grain_at(ContactLaw{law, Cohesionless{}, Frictionless{}},
                            places[0],
                            (k + 0.5) / phases * step,
                            {0.0, 0.0, -1.0},
                            {},
                            step);
      pass_contact(grain);
      sum += velocity_of(grain, 0).z / phases;
    }
    EXPECT_NEAR(sum, exact.restitution, 1e-5);
  };
  check(hooke, hooke.collision_time(mass_of(1.2)));
  check(hertz, hertz.collision_time(mass_of(1.2), 0.6, 1.0));
}

TEST(Wall, ASmoothOneDoesNotTurnGrains) {
  for (const AtWall& place : places) {
    const AtWall slippery{smooth(place.wall), place.inward, place.foot};
    const ContactLaw law{hooke, Cohesionless{}, sliding};
    const Vec3 spin{0.5, 1.0, -2.0};
    auto grain = grain_at(law, slippery, 0.001, Vec3{0.0, 0.0, 0.7} - place.inward, spin, 5e-5);
    ASSERT_GT(pass_contact(grain), 20);
    EXPECT_EQ(grain.spin(0), 0.6 * spin);
    EXPECT_NEAR(grain.velocity(0).z, 0.7, place.inward.z == 0.0 ? 1e-15 : 2.0);
  }
}

// Without slip from friction mu g until v = R omega: m R v_0 = (m R + 2/5 m R) v.
TEST(Wall, ASlidingGrainEndsUpRollingWithFiveSeventhsOfItsVelocity) {
  SimulationSetup setup = free_flight(1e-4);
  setup.dynamics.field = Uniform{{0.0, 0.0, -1.0}};
  setup.walls = {floor_wall};
  const auto check = [&](const auto& friction) {
    InitialState one;
    const double sag = 1.0 / hooke.stiffness;
    one.grains = {{.position = {0.0, 0.0, 0.5 - sag}, .velocity = {0.7, -0.2, 0.0}}};
    Simulation grain(ContactLaw{hooke, Cohesionless{}, friction}, setup, one);
    while (grain.time() < 2.0) grain.step();
    // The arm is shorter by the overlap of 5e-6 d; the dashpot has calmed the tangential spring.
    const Vec3 expected = 5.0 / 7.0 * one.grains[0].velocity;
    EXPECT_NEAR(grain.velocity(0).x, expected.x, 2e-5 * 0.7);
    EXPECT_NEAR(grain.velocity(0).y, expected.y, 2e-5 * 0.7);
    EXPECT_NEAR(grain.spin(0).y, expected.x, 4e-5 * 0.7);
    EXPECT_NEAR(grain.spin(0).x, -expected.y, 4e-5 * 0.7);
  };
  check(sliding);
  check(stick_slip);
}

// At the bottom of a drum that turns a grain is pulled to the velocity of the surface: 2/7 of it in
// translation, 5/7 in rotation, as the 5/7 above seen from the surface.
TEST(Wall, ATurningDrumSpinsAGrainUpToItsSurfaceVelocity) {
  SimulationSetup setup = free_flight(1e-4);
  setup.dynamics.field = Uniform{{0.0, -1.0, 0.0}};
  constexpr double rate = 0.02;
  setup.walls = {{.shape = Cylinder{.radius = 5.0, .rotation_rate = rate}}};
  InitialState one;
  one.grains = {{.position = {0.0, -4.5 - 1.0 / hooke.stiffness, 0.0}}};
  Simulation grain(ContactLaw{hooke, Cohesionless{}, sliding}, setup, one);
  while (grain.time() < 1.0) grain.step();
  const double surface = rate * 5.0;
  // The grain swings about the bottom but rolls all the time.
  EXPECT_NEAR(grain.velocity(0).x + grain.spin(0).z, surface, 1e-3 * surface);
}

}  // namespace
}  // namespace grainlaw::dem
