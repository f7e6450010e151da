// Changes that must not change a bit: units of time, and laws whose parameters vanish.
#include <gtest/gtest.h>

#include <iostream>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// A falling, sliding column after some steps; `faster` is a factor on velocities.
template <class Law>
Motions column(const Law& law, double faster, int steps, double nudge = 0.0) {
  Scene scene = small_chute(25.0);
  auto& chute = std::get<Chute>(scene.geometry);
  chute.gravity = faster * faster;
  scene = with(scene, law, 50.0);
  scene.time_step = soft.contact_time(0.5) / 50.0 / faster;
  InitialState start = initial_state(scene);
  for (std::size_t k = 0; k < start.grains.size(); ++k) {
    if (start.grains[k].body == Body::none) {
      start.grains[k].velocity = faster * (1.0 + nudge) * scatter(k);
    }
  }
  // One list for all laws: its order is that of sums. A skin that lasts for all steps.
  SimulationSetup setup = flow_setup(scene, start);
  setup.skin = 0.8 - law.range();
  Simulation simulation(law, setup, start);
  for (int k = 0; k < steps; ++k) simulation.step();
  if constexpr (Law::attracts) {
    EXPECT_EQ(simulation.rebuilds(), 1);
  }
  if constexpr (Law::rotates) {
    if (law.friction.coefficient > 0.0) {
      EXPECT_GT(simulation.ledger().slip, 0.0);
    }
  }
  return motions(simulation);
}

/// Grains that differ in any bit after velocities of `a` are multiplied.
std::size_t differing(const Motions& a, const Motions& b, double faster = 1.0) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.position.size(); ++k) {
    count += !(a.position[k] == b.position[k] && faster * a.velocity[k] == b.velocity[k] &&
               faster * a.spin[k] == b.spin[k]);
  }
  return count;
}

/// The law with four times the stiffness and twice the damping.
Hooke faster(Hooke law) {
  law.stiffness *= 4.0;
  law.damping *= 2.0;
  return law;
}
Hertz faster(Hertz law) {
  law.stiffness *= 4.0;
  law.damping *= 2.0;
  return law;
}

template <class Normal>
void expect_exact_scaling(const Normal& normal) {
  const Sliding friction = sliding(0.5, 2e4, 5.0);
  Sliding faster_friction = friction;
  faster_friction.stiffness *= 4.0;
  faster_friction.damping *= 2.0;
  const Motions slow = column(ContactLaw{normal, Cohesionless{}, friction}, 1.0, 600);
  const Motions fast =
      column(ContactLaw{faster(normal), Cohesionless{}, faster_friction}, 2.0, 600);
  EXPECT_EQ(differing(slow, fast, 2.0), 0u);
}

// In half the time, with four times all accelerations: every number is multiplied by a power of 2.
TEST(Scaling, TwiceTheSpeedIsExactForHooke) {
  expect_exact_scaling(soft);
}
TEST(Scaling, TwiceTheSpeedIsExactForHertz) {
  expect_exact_scaling(Hertz{.stiffness = 2e5, .damping = 150.0});
}

/// A law whose parameters vanish moves grains like the law without them.
template <class Law, class Simpler>
void expect_same_path(const Law& law, const Simpler& simpler) {
  EXPECT_EQ(differing(column(law, 1.0, 600), column(simpler, 1.0, 600)), 0u);
}

/// The same but for rounding: a compiler may join other multiplications and additions in other
/// laws. Some last bits of each velocity at the start make as much of a difference.
template <class Law, class Simpler>
void expect_same_but_for_rounding(const Law& law, const Simpler& simpler) {
  const Motions expected = column(simpler, 1.0, 600);
  const Motions found = column(law, 1.0, 600);
  const Motions nudged = column(simpler, 1.0, 600, 1e-15);
  double off = 0.0, growth = 0.0;
  for (std::size_t k = 0; k < expected.velocity.size(); ++k) {
    off = std::max(off, length(expected.velocity[k] - found.velocity[k]));
    growth = std::max(growth, length(expected.velocity[k] - nudged.velocity[k]));
  }
  std::cout << "off by " << off << ", a nudge of 1e-15 grows to " << growth << '\n';
  EXPECT_LT(growth, 1e-10);  // so that the comparison means something
  EXPECT_LE(off, 10.0 * growth);
}

TEST(VanishingParameters, FrictionOfCoefficientZeroIsNoFriction) {
  expect_same_but_for_rounding(ContactLaw{soft, Cohesionless{}, sliding(0.0, 2e4)}, smooth(soft));
  const Hertz hertz{.stiffness = 2e5, .damping = 150.0};
  expect_same_but_for_rounding(ContactLaw{hertz, Cohesionless{}, sliding(0.0, 2e4)},
                               ContactLaw{hertz, Cohesionless{}, Frictionless{}});
}

TEST(VanishingParameters, StaticFrictionNoHigherThanDynamicIsSliding) {
  const StickSlip stick{
      .static_coefficient = 0.5, .coefficient = 0.5, .stiffness = 6e3, .damping = 5.0};
  const Sliding slide{.coefficient = 0.5, .stiffness = 6e3, .damping = 5.0};
  expect_same_but_for_rounding(ContactLaw{soft, Cohesionless{}, stick},
                               ContactLaw{soft, Cohesionless{}, slide});
}

TEST(VanishingParameters, AttractionOfNoStrengthIsNone) {
  const auto simpler = rough(soft, 0.5);
  const Sliding friction = simpler.friction;
  const auto total = CoulombReference::total;
  expect_same_path(ContactLaw{soft, GaussianWell{.strength = 0.0, .width = 0.01}, friction},
                   simpler);
  expect_same_path(
      ContactLaw{soft,
                 ReversibleAdhesion{.largest_force = 0.0, .slope = 500.0, .reference = total},
                 friction},
      simpler);
  expect_same_path(
      ContactLaw{
          soft,
          LiquidBridge{
              .surface_tension = 0.0, .contact_angle = 0.2, .volume = 2e-4, .reference = total},
          friction},
      simpler);
}

}  // namespace
}  // namespace grainlaw::dem
