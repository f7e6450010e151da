// Stiff and extreme chutes: every one ends in a typed answer. The results are listed in
// docs/stability.md.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

const RheologyTable frictional = table_of(frictional_spheres());
const RheologyTable cohesive_bagnold = table_of(bagnold_at_24_degrees(1.3, 0.8, 6.0));

/// Steady only by the residual, and then with the error that regularisation is known to make, delta
/// times the plug depth over the velocity.
TEST(Extremes, RegularisedYieldStressIsRightOrSaysThatItIsNotConverged) {
  const double exact = 28.020844029, plug = 25.4337241611;
  for (const double delta : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10})
    for (const double atol : {1e-8, 1e-12}) {
      const TransientOptions options{
          .cells = 50, .absolute_tolerance = atol, .yield_regularisation = delta};
      if (delta < 100.0 * atol) {
        EXPECT_THROW(start_from_rest(cohesive_bagnold, chute(24, 29), options),
                     std::invalid_argument);
        continue;
      }
      const auto run = start_from_rest(cohesive_bagnold, chute(24, 29), options);
      if (run.answer.outcome == Outcome::not_converged) continue;
      ASSERT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
      EXPECT_LE(run.residual, 1e-8);
      // 1.2 for the delta^2 of the sheared part, and a plug edge inside a cell of 1/50 of the mass
      EXPECT_NEAR(
          run.final_profile.surface_velocity / exact, 1.0, 1.2 * delta * plug / exact + 2e-3);
    }
}

TEST(Extremes, JustAboveReposeTheSlowFlowIsRightToTheGridError) {
  for (const auto& [theta, I] : {std::pair{19.45, 2.8e-4}, {19.5, 2.2e-3}}) {
    const auto run = start_from_rest(frictional, chute(theta, 52.2));
    EXPECT_EQ(run.answer.outcome, Outcome::steady);
    EXPECT_NEAR(run.final_profile.rows.front().inertial_number, I, 0.05 * I);  // two digits
    EXPECT_NEAR(run.final_profile.surface_velocity,
                *run.quadrature_surface_velocity,
                1e-4 * *run.quadrature_surface_velocity);
  }
}

TEST(Extremes, SoftGrainsWithoutASteadyStateAccelerateInTime) {
  const auto outcome = [](double theta, double stiffness) {
    return start_from_rest(frictional, chute(theta, 52.2, {.stiffness = stiffness}), {.cells = 50})
        .answer.outcome;
  };
  EXPECT_EQ(outcome(30, 3819.72), Outcome::no_dense_state);
  EXPECT_EQ(outcome(33, 3819.72), Outcome::accelerating);
  EXPECT_EQ(outcome(24, 1047.2), Outcome::no_dense_state);
}

TEST(Extremes, AnyCohesionLeavesAFiniteYieldStressAtTheSurface) {
  double previous = 0.0;
  for (const double f_a : {1e-6, 1e-3, 0.1, 1.0, 5.0, 10.0}) {
    const auto run = start_from_rest(frictional, chute(24, 52.2, {.adhesion = f_a}), {.cells = 50});
    EXPECT_EQ(run.answer.outcome, Outcome::plug) << f_a << run.answer.text;
    EXPECT_GE(run.final_profile.plug_mass, previous);  // equal below a cell
    previous = run.final_profile.plug_mass;
    // the first cell, which a plug thinner than it misses, has 1/50^1.5 of the mass
    EXPECT_NEAR(run.final_profile.surface_velocity / *run.quadrature_surface_velocity, 1.0, 3e-3);
  }
  const auto held = start_from_rest(frictional, chute(24, 52.2, {.adhesion = 100.0}));
  EXPECT_EQ(held.answer.outcome, Outcome::arrested);
}

TEST(Extremes, BeyondTheFitsPhiStaysPositiveAndTheFractionIsFlagged) {
  auto table = frictional;
  table.range = {.inertial_number = Range{0.005, 0.5},
                 .softness = Range{0.0, 0.03},
                 .bond_number = Range{0.0, 5.0}};
  for (const MuPhi& law : {frictional_spheres(), slippery_spheres()})
    for (const double Bo : {7.0, 10.0, 20.0, 1e3}) {
      const Confinement at{.softness = 0.01, .bond_number = Bo};
      EXPECT_GT(volume_fraction(law, 0.1, at), 0.4);
      EXPECT_LT(volume_fraction(law, 0.1, at), 0.8);
    }
  const auto fast = steady_chute(table, chute(28, 52.2));  // I = 0.63
  ASSERT_EQ(fast.answer.out_of_domain.size(), 1u);
  EXPECT_EQ(fast.answer.out_of_domain[0].fraction_outside, 1.0);
  const auto soft = steady_chute(table, chute(22, 52.2, {.stiffness = 1000.0}));
  EXPECT_EQ(soft.answer.out_of_domain.at(0).quantity, "I");
  EXPECT_EQ(soft.answer.out_of_domain.at(1).quantity, "p*");
}

TEST(Extremes, ThinAndDeepLayersAndCoarseGridsRun) {
  for (const double mass : {0.5, 1e5}) {
    const auto run = start_from_rest(frictional, chute(24, mass));
    EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
    EXPECT_NEAR(run.final_profile.surface_velocity / *run.quadrature_surface_velocity, 1.0, 1e-5);
  }
  for (const int cells : {2, 3}) {
    const auto run = start_from_rest(cohesive_bagnold, chute(24, 29), {.cells = cells});
    EXPECT_EQ(run.answer.outcome, Outcome::plug) << run.answer.text;
    EXPECT_NE(run.answer.text.find("coarse"), std::string::npos);
  }
}

TEST(Extremes, CoulombGrainsRestOrAccelerate) {
  MuPhi coulomb = incompressible_spheres();
  coulomb.friction = {.mu0 = 0.4};
  EXPECT_EQ(start_from_rest(table_of(coulomb), chute(20, 30)).answer.outcome, Outcome::arrested);
  const auto run = start_from_rest(table_of(coulomb), chute(24, 30), {.time_limit = 10.0});
  EXPECT_EQ(run.answer.outcome, Outcome::accelerating);
  const double block = 10.0 * (std::sin(24 * degree) - 0.4 * std::cos(24 * degree));
  EXPECT_NEAR(run.final_profile.surface_velocity, block, 1e-6 * block);
}

TEST(Extremes, NoReposeAtAllFlowsAtAnyTilt) {
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = 0.0, .beta = 1.0};
  const auto run = start_from_rest(table_of(law), chute(0.1, 30));
  EXPECT_EQ(run.answer.outcome, Outcome::steady) << run.answer.text;
  EXPECT_NEAR(run.final_profile.surface_velocity / *run.quadrature_surface_velocity, 1.0, 1e-5);
}

TEST(Extremes, FailureOfTheSolverIsAnAnswerWithPlaceVariableAndTime) {
  // without any friction above yield, a stress that some grains cannot carry has no answer
  MuPhi coulomb = incompressible_spheres();
  coulomb.friction = {.mu0 = 0.4};
  coulomb.cohesion_stress = CohesionStress{.factor = 0.3};
  const auto run = start_from_rest(table_of(coulomb), chute(26, 30, {.adhesion = 1.0}));
  EXPECT_EQ(run.answer.outcome, Outcome::not_converged) << run.answer.text;
  for (const char* part : {"t = ", "cell", "mass above", "the law can carry"})
    EXPECT_NE(run.answer.text.find(part), std::string::npos) << run.answer.text;
}

TEST(Extremes, PowerLawFlowsInTimeAsByQuadrature) {
  MuPhi law = frictional_spheres();
  law.friction = {.mu0 = 0.3530, .beta = 0.4, .exponent = 0.7};
  for (const GrainProperties& grains : {GrainProperties{}, GrainProperties{.adhesion = 5.0}}) {
    const auto run = start_from_rest(table_of(law), chute(24, 52.2, grains), {.cells = 100});
    EXPECT_TRUE(flows(run.answer.outcome)) << run.answer.text;
    EXPECT_NEAR(run.final_profile.surface_velocity / *run.quadrature_surface_velocity, 1.0, 1e-4);
  }
}

}  // namespace
}  // namespace grainlaw::continuum
