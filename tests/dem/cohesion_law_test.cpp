#include <gtest/gtest.h>

#include "dem/cohesion_laws.h"
#include "tests/dem/pair_support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

constexpr double degree = std::numbers::pi / 180.0;

Contact at_overlap(double overlap, double harmonic_radius = 0.5) {
  Contact c;
  c.overlap = overlap;
  c.harmonic_radius = harmonic_radius;
  return c;
}

/// Attraction at a gap, of a pair with its bridge.
double pull(const auto& law, double gap, double harmonic_radius = 0.5) {
  return -law.force(at_overlap(-gap, harmonic_radius), true);
}

// Brewster et al. 2008, eq. 5 at A = 1.
TEST(GaussianWell, AttractsAsBrewsterAndOthersSay) {
  const GaussianWell unit{.strength = 1.0, .width = 0.01};
  EXPECT_NEAR(unit.largest_attraction(0.5), 85.7764, 5e-5);
  EXPECT_NEAR(pull(unit, -0.01 * (1.0 - std::numbers::sqrt2 / 2.0)), 85.7764, 5e-5);
  EXPECT_NEAR(pull(unit, 0.0), 73.5759, 5e-5);
  EXPECT_NEAR(pull(unit, 0.02 * (1.0 - 1e-12)), 0.0740459, 5e-8);
  EXPECT_EQ(pull(unit, 0.02), 0.0);
  EXPECT_LT(pull(unit, -0.011), 0.0);  // inside its centre the well pushes
}

// Their eq. 12; without a solution below A = 0.011658.
TEST(GaussianWell, EffectiveRangeIsWhereAPairCarriesTheWeightOfAGrain) {
  const auto range = [](double strength) {
    return GaussianWell{.strength = strength, .width = 0.01}.effective_range(1.0);
  };
  EXPECT_NEAR(1.0 + range(0.6), 1.013777, 5e-7);
  EXPECT_NEAR(1.0 + range(0.1), 1.009084, 5e-7);
  EXPECT_EQ(range(0.011657), 0.0);
  EXPECT_EQ(range(0.0135), 0.0);  // a solution, but inside contact
  EXPECT_GT(range(0.0137), 0.0);
  EXPECT_NEAR(pull(well, well.effective_range(1.0)), 1.0, 1e-9);
}

// Shi et al. 2020, eq. 3: delta_a = f_max / k_ca = 0.1 mm for 0.01 N and 100 kg/s^2.
TEST(ReversibleAdhesion, IsContinuousAndEndsWhereItsSlopeSays) {
  const ReversibleAdhesion law{.largest_force = 0.01, .slope = 100.0};
  EXPECT_DOUBLE_EQ(law.range(), 1e-4);
  EXPECT_EQ(pull(law, -1e-5), 0.01);
  EXPECT_EQ(pull(law, 0.0), 0.01);
  EXPECT_NEAR(pull(law, 1e-12), 0.01, 1.01e-10);
  EXPECT_NEAR(pull(law, 0.5e-4), 0.005, 1e-15);
  EXPECT_NEAR(pull(law, 1e-4), 0.0, 1e-17);
  EXPECT_EQ(pull(law, 1.1e-4), 0.0);
}

// Shi et al. 2020, table 1: 20 degrees, 75 nl, gamma_s 0.3 N/m, R = 1.1 mm (their S_c corrected).
constexpr LiquidBridge water{
    .surface_tension = 0.3, .contact_angle = 20.0 * degree, .volume = 75e-12};

TEST(LiquidBridge, HoldsAndRupturesAsShiAndOthersSay) {
  EXPECT_NEAR(water.range(), 4.95320e-4, 5e-10);
  EXPECT_NEAR(water.largest_attraction(1.1e-3), 1.948407e-3, 5e-10);
  EXPECT_DOUBLE_EQ(pull(water, 0.0, 1.1e-3), water.largest_attraction(1.1e-3));
  EXPECT_DOUBLE_EQ(pull(water, -1e-5, 1.1e-3), water.largest_attraction(1.1e-3));
  const double left = pull(water, water.range(), 1.1e-3) / water.largest_attraction(1.1e-3);
  EXPECT_NEAR(left, 0.083, 5e-4);
  EXPECT_EQ(water.force(at_overlap(-1e-5, 1.1e-3), false), 0.0);
}

TEST(LiquidBridge, ReducedRadiusIsTheHarmonicMeanAndTwiceTheRadiusAtAWall) {
  EXPECT_DOUBLE_EQ(harmonic_radius(0.7, 0.7), 0.7);
  EXPECT_DOUBLE_EQ(harmonic_radius(0.3, 0.6), 0.4);
  EXPECT_DOUBLE_EQ(harmonic_radius(0.3, 0.0), 0.6);
}

/// The part of the work that an interval of gaps takes, by the midpoint rule.
double work(const auto& law, double from, double to, double radius) {
  constexpr int parts = 100'000;
  const double step = (to - from) / parts;
  double sum = 0.0;
  for (int k = 0; k < parts; ++k) sum += step * pull(law, from + (k + 0.5) * step, radius);
  return sum;
}

TEST(Cohesion, EnergyIsMinusTheIntegralOfTheForce) {
  const auto check = [](const auto& law, double radius) {
    const double unit = law.largest_attraction(radius) * law.range();
    for (const auto& [from, to] : {std::pair{-0.5, 0.0}, {-0.1, 0.3}, {0.0, 0.5}, {0.2, 0.999}}) {
      const double gained = law.energy(at_overlap(-to * law.range(), radius), true) -
                            law.energy(at_overlap(-from * law.range(), radius), true);
      // Midpoint rule: (step / scale of the law)^2; a kink within a part costs step^2 once.
      EXPECT_NEAR(gained, work(law, from * law.range(), to * law.range(), radius), 1e-8 * unit);
    }
  };
  check(well, 0.5);
  check(adhesion, 0.5);
  check(liquid, 0.5);
  check(water, 1.1e-3);
}

TEST(LiquidBridge, WorkUpToRuptureHasItsClosedForm) {
  // Integral of 1 / (1 + 1.05 s + 2.5 s^2): 2/q (atan((5 s + 1.05)/q) - atan(1.05/q)),
  // q^2 = 10 - 1.05^2.
  const double unit = std::sqrt(water.volume / 1.1e-3);
  const double q = std::sqrt(10.0 - 1.05 * 1.05);
  const double s = water.range() / unit;
  const double closed = water.largest_attraction(1.1e-3) * unit * 2.0 / q *
                        (std::atan((5.0 * s + 1.05) / q) - std::atan(1.05 / q));
  EXPECT_NEAR(water.rupture_energy(1.1e-3), closed, 1e-12 * closed);
  EXPECT_NEAR(work(water, 0.0, water.range(), 1.1e-3), closed, 1e-8 * closed);
}

/// What one slow collision without damping shows: kinetic energy lost, largest pull, and the gaps
/// at which the pull began and ended.
struct Cycle {
  double lost = 0.0;
  double residual = 0.0;  ///< of the ledger
  double largest_pull = 0.0;
  double begins = 0.0;
  double ends = 0.0;
  int touches = 0;
};
template <class Cohesion>
Cycle collide_slowly(const Cohesion& cohesion, double first, double second) {
  const Hooke elastic{.stiffness = 2e5};
  const double speed = 5.0;  // enough to leave the bridge
  const double step = elastic.contact_time(reduced_mass(first, second)) / 2000.0;
  const double radius_sum = 0.5 * (first + second);
  Simulation pair(ContactLaw{elastic, cohesion, Frictionless{}},
                  free_flight(step),
                  pair_on_x(first, second, 2.0 * cohesion.range(), {speed, 0.0, 0.0}));
  const double energy = pair.kinetic_energy();
  Cycle cycle;
  bool touched = false;
  double distance = 2.0;
  do {
    bool pulls = false;
    pair.step([&](std::uint32_t, std::uint32_t, const Vec3& branch, const Vec3& force) {
      const double along = dot(force, branch) / length(branch);
      distance = length(branch);
      pulls = along < 0.0;
      cycle.largest_pull = std::max(cycle.largest_pull, -along);
    });
    if (pulls && cycle.begins == 0.0) cycle.begins = distance - radius_sum;
    if (pulls) cycle.ends = distance - radius_sum;
    const bool touches = pair.acting_pairs() > 0 && distance < radius_sum;
    cycle.touches += touches && !touched;
    touched = touches;
  } while (pair.acting_pairs() > 0 || cycle.touches == 0);
  cycle.lost = energy - pair.kinetic_energy();
  cycle.residual = pair.ledger().residual(pair.mechanical_energy());
  return cycle;
}

TEST(Cohesion, ReversibleLawsGiveBackWhatTheyTake) {
  const auto check = [](const auto& law) {
    const Cycle cycle = collide_slowly(law, 1.0, 1.0);
    const double step_way = 5.0 * Hooke{.stiffness = 2e5}.contact_time(0.5) / 2000.0;
    EXPECT_EQ(cycle.touches, 1);
    EXPECT_NEAR(cycle.begins, law.range(), step_way);
    EXPECT_NEAR(cycle.ends, law.range(), step_way);
    // The well is cut where it pulls with 3 A / l 2 exp(-9): a step more or less of that.
    const double jump = pull(law, law.range() * (1.0 - 1e-9)) * step_way;
    EXPECT_NEAR(cycle.lost, 0.0, 2.0 * jump + 1e-5);
    EXPECT_NEAR(cycle.residual, 0.0, 2.0 * jump + 1e-5);
  };
  check(well);
  check(adhesion);
}

TEST(LiquidBridge, FormsAtTheFirstTouchOnlyAndCostsItsRuptureEnergyOnce) {
  for (const auto& [first, second] : {std::pair{1.0, 1.0}, {0.6, 1.4}}) {
    const Cycle cycle = collide_slowly(liquid, first, second);
    const double radius = harmonic_radius(0.5 * first, 0.5 * second);
    const double step_way =
        5.0 * Hooke{.stiffness = 2e5}.contact_time(reduced_mass(first, second)) / 2000.0;
    EXPECT_EQ(cycle.touches, 1);
    EXPECT_LT(cycle.begins, step_way);  // nothing on the way in
    EXPECT_NEAR(cycle.ends, liquid.range(), step_way);
    // Where the force jumps, at the first touch and at rupture, the time is known to a step.
    const double at_rupture = pull(liquid, liquid.range(), radius);
    const double jumps = (liquid.largest_attraction(radius) + at_rupture) * step_way;
    EXPECT_NEAR(cycle.lost, liquid.rupture_energy(radius), jumps);
    EXPECT_NEAR(cycle.residual, 0.0, jumps);
  }
}

TEST(LiquidBridge, DoesNotFormWithoutTouch) {
  // Passing by at a gap of a tenth of the range.
  InitialState passing;
  passing.grains = {{.position = {-0.3, 0.0, 0.0}, .velocity = {10.0, 0.0, 0.0}},
                    {.position = {0.0, 1.0 + 0.1 * liquid.range(), 0.0}}};
  Simulation pair(ContactLaw{hooke, liquid, Frictionless{}}, free_flight(1e-4), passing);
  std::size_t acted = 0;
  for (int n = 0; n < 600; ++n) {
    pair.step();
    acted += pair.acting_pairs();
  }
  EXPECT_GT(acted, 0u);
  EXPECT_EQ(velocity_of(pair, 0), (Vec3{10.0, 0.0, 0.0}));
  EXPECT_EQ(pair.ledger().bridge_lost, 0.0);
}

TEST(LiquidBridge, RupturesOnceAndFormsAgainAtTheNextTouch) {
  // A heavy frozen grain below: the grain falls on it, leaves, and falls again.
  InitialState falling;
  falling.grains = {{.position = {0.0, 0.0, 1.05}}, {.position = {}, .body = Body::base}};
  SimulationSetup setup = free_flight(5e-5);
  setup.dynamics.field = Uniform{{0.0, 0.0, -1000.0}};
  const Hooke elastic{.stiffness = 2e5};
  Simulation bounce(ContactLaw{elastic, liquid, Frictionless{}}, setup, falling);
  while (bounce.ledger().bridge_lost == 0.0) bounce.step();
  const double first = bounce.ledger().bridge_lost;
  EXPECT_NEAR(first, liquid.rupture_energy(0.5), 1e-12 * first);
  bool apart = true, again = false;
  for (int n = 0; n < 4000 && !again; ++n) {
    bounce.step();
    const double gap = position_of(bounce, 0).z - 1.0;
    if (apart && gap > 0.0) {
      EXPECT_EQ(bounce.ledger().bridge_lost, first);
    }
    apart = apart && gap > 0.0;
    again = bounce.ledger().bridge_lost > first;
  }
  EXPECT_NEAR(bounce.ledger().bridge_lost, 2.0 * first, 1e-12 * first);
}

// A = 0.6, k_n = 2e5: grains at rest overlap by 2.26e-4 d.
TEST(GaussianWell, GrainsComeToRestWhereTheSpringBalancesTheWell) {
  Simulation pair(
      ContactLaw{hooke, well, Frictionless{}}, free_flight(5e-5), pair_on_x(1.0, 1.0, 0.0, {}));
  for (int n = 0; n < 20'000; ++n) pair.step();
  const double overlap = 1.0 - length(position_of(pair, 0) - position_of(pair, 1));
  EXPECT_NEAR(hooke.stiffness * overlap, pull(well, -overlap), 1e-8);
  EXPECT_NEAR(overlap, 2.26e-4, 0.5e-6);
}

TEST(Cohesion, CoulombReferenceIsTheWholeForceOrTheRepulsionAlone) {
  // Brewster et al.: |F_n| with cohesion; Shi et al.: the part above the adhesion, not below 0.
  EXPECT_EQ(coulomb_reference(CoulombReference::total, 5.0, -8.0), 3.0);
  EXPECT_EQ(coulomb_reference(CoulombReference::repulsive, 5.0, -8.0), 5.0);
  EXPECT_EQ(coulomb_reference(CoulombReference::repulsive, -1.0, -8.0), 0.0);
  EXPECT_EQ(GaussianWell{}.reference, CoulombReference::total);
  EXPECT_EQ(ReversibleAdhesion{}.reference, CoulombReference::repulsive);
  EXPECT_EQ(LiquidBridge{}.reference, CoulombReference::repulsive);
}

TEST(Cohesion, AtTheEquilibriumOverlapBrewstersFrictionVanishesAndShisDoesNot) {
  // With k_ca = k_n the equilibrium overlap of Shi et al. is delta_a.
  ReversibleAdhesion law{.largest_force = 20.0, .slope = 2e5};
  Contact rest = at_overlap(law.range());
  rest.normal = {1.0, 0.0, 0.0};
  rest.reduced_mass = rest.radius_sum = 1.0;
  rest.distance = 1.0 - rest.overlap;
  const TangentialMotion<double> slides{.surface_velocity = {0.0, 1.0, 0.0}, .normal_rate = {}};
  const auto friction = [&](CoulombReference reference) {
    law.reference = reference;
    TangentialSpring<double> spring{.stretch = {0.0, 0.1, 0.0}};
    return length(
        contact_force(ContactLaw{hooke, law, sliding}, rest, slides, 1.0, false, 1e-4, spring)
            .tangential);
  };
  EXPECT_NEAR(friction(CoulombReference::repulsive), 0.5 * 20.0, 1e-12);
  EXPECT_NEAR(friction(CoulombReference::total), 0.0, 1e-12);
}

}  // namespace
}  // namespace grainlaw::dem
