#include "continuum/rheology.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "continuum/bagnold_profile.h"
#include "continuum/dual.h"
#include "continuum/flow_curve.h"
#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// The derivative of f at x through Dual against central differences. Rounding 1e-16 / h and
/// truncation h^2 meet near h = 1e-5: 1e-9 relative to the scale of f / x.
template <class Function>
void expect_derivative(Function f, double x) {
  const double h = 1e-5 * x;
  const double difference = (f(x + h) - f(x - h)) / (2.0 * h);
  const double scale = std::abs(f(x) / x) + std::abs(difference);
  EXPECT_NEAR(f(Dual<1>::variable(x, 0)).slope[0], difference, 1e-9 * scale);
}

TEST(Laws, DerivativesWithRespectToCoefficientsMatchFiniteDifferences) {
  expect_derivative([](auto mu0) { return inertial_friction(mu0, mu0 * 2.0, mu0 * 3.0, 0.2); },
                    0.4);
  expect_derivative([](auto x) { return inertial_number_of(x, x * 4.0, x, 0.5); }, 0.4);
  expect_derivative([](auto p_mu) { return softness_friction(p_mu, 0.01); }, 0.39);
  expect_derivative([](auto beta) { return cohesion_friction(beta * 0.2, beta, 2.0); }, 1.5);
  expect_derivative([](auto beta) { return cohesion_friction(beta * 0.2, beta, 9.0); }, 1.5);
  expect_derivative([](auto phi0) { return inertial_volume_fraction(phi0, phi0 * 9.0, 0.1); }, 0.6);
  expect_derivative([](auto p) { return cohesion_volume_fraction(p, p * 0.5, p, p, 2.0); }, 0.1);
}

constexpr double stress_per_depth = 0.2359;

TEST(Laws, BagnoldVelocityHasTheDerivativesOfFiniteDifferences) {
  expect_derivative(
      [](auto a) { return bagnold_velocity(a, a * 0.6, a * 4.0, stress_per_depth, 50.0, 30.0); },
      1.3);
  expect_derivative(
      [](auto b) { return bagnold_velocity(b * 0.0 + 1.3, b, b, stress_per_depth, 50.0, 3.0); },
      0.8);
  expect_derivative(
      [](auto h) {
        return bagnold_velocity(h * 0.02, h * 0.01, h * 0.0, stress_per_depth, h, 9.0);
      },
      50.0);
}

TEST(GeneralisedBagnold, ShearRateInvertsTheStressAlsoWithoutOneOfItsTerms) {
  for (const auto& [a, b] :
       {std::pair{1.3, 0.8}, {1.3, 0.0}, {0.0, 0.8}, {1e-12, 0.8}, {1.3, 1e-12}})
    for (const double rate : {1e-6, 1e-3, 0.3, 20.0}) {
      const double excess = bagnold_shear_stress(a, b, 0.0, rate);
      EXPECT_NEAR(bagnold_shear_rate(a, b, excess), rate, 1e-14 * rate);
    }
}

TEST(GeneralisedBagnold, NothingShearsUpToTheYieldStress) {
  EXPECT_EQ(bagnold_shear_rate(1.3, 0.0, 0.0), 0.0);
  EXPECT_EQ(bagnold_shear_rate(1.3, 0.8, -2.0), 0.0);
}

TEST(FlowCurve, InverseOfTheStressIsTheShearRateForBothClosures) {
  const GrainProperties soft{.stiffness = 1e4, .adhesion = 0.5};
  for (const double p : {0.3, 5.0, 60.0})
    for (const double q : {1e-6, 1e-3, 0.1, 2.0}) {
      for (const FlowCurve& curve : {flow_curve(frictional_spheres(), soft, p),
                                     flow_curve(bagnold_at_24_degrees(1.3, 0.8, 6.0), soft, p)}) {
        const double tau = curve.yield_stress + curve.viscous_stress(q);
        // tau - tau_y has lost tau_y / viscous stress of its digits
        const double tolerance = 4e-16 * (1.0 + tau / curve.viscous_stress(q));
        EXPECT_NEAR(curve.scaled_rate(tau).value(), q, 4.0 * tolerance * q);
      }
    }
}

TEST(FlowCurve, SlopeMatchesFiniteDifferencesForBothClosures) {
  for (const FlowCurve& curve : {flow_curve(frictional_spheres(), {}, 5.0),
                                 flow_curve(bagnold_at_24_degrees(1.3, 0.8, 6.0), {}, 5.0)})
    for (const double q : {-0.5, 0.01, 0.3, 4.0}) {
      const double h = 1e-5 * std::abs(q);
      const double difference =
          (curve.viscous_stress(q + h) - curve.viscous_stress(q - h)) / (2.0 * h);
      EXPECT_NEAR(curve.viscous_slope(q), difference, 1e-9 * curve.viscous_slope(q));
    }
}

TEST(FlowCurve, IsTheLawOfTheTableInAnotherVariable) {
  const MuPhi law = frictional_spheres();
  const GrainProperties grains{.stiffness = 2e3, .adhesion = 0.7};
  const double p = 3.0;
  const FlowCurve curve = flow_curve(law, grains, p);
  const Confinement at = confinement(grains, p);
  for (const double q : {0.001, 0.1, 3.0}) {
    const double I = curve.shear_rate(q) / std::sqrt(p);
    EXPECT_NEAR(curve.yield_stress + curve.viscous_stress(q), p * friction(law, I, at), 1e-14 * p);
    EXPECT_NEAR(curve.volume_fraction(q), volume_fraction(law, I, at), 1e-15);
    EXPECT_LT(I, law.volume_fraction.I_phi);
  }
}

/// One law of every family.
std::vector<MuPhi> families() {
  std::vector<MuPhi> laws(6, frictional_spheres());
  laws[1].softness_friction->form = SoftnessForm::linear;
  laws[2].cohesion_friction.reset();
  laws[2].cohesion_stress = CohesionStress{.factor = 0.4};
  laws[3].friction = {.mu0 = 0.3530, .beta = 0.4, .exponent = 0.7};
  laws[4].softness_friction.reset();
  laws[5].cohesion_friction.reset();
  laws[5].cohesion_stress =
      CohesionStress{.factor = 1.5, .bond_exponent = 1.44, .softness_exponent = 0.67};
  return laws;
}

TEST(LawFamilies, StressHasTheDerivativesOfFiniteDifferences) {
  const GrainProperties grains{.diameter = 0.7, .density = 2.5, .stiffness = 2e3, .adhesion = 0.9};
  for (const MuPhi& law : families())
    for (const double p : {0.2, 3.0, 40.0})  // Bo beyond and below 5
      for (const double rate : {0.01, 0.8}) {
        const auto at = [&](double gd, double pressure) {
          return stress_response(law, grains, gd, pressure).stress;
        };
        const StressResponse response = stress_response(law, grains, rate, p);
        const double dg = 1e-5 * rate, dp = 1e-5 * p;
        const double by_rate = (at(rate + dg, p) - at(rate - dg, p)) / (2.0 * dg);
        const double by_pressure = (at(rate, p + dp) - at(rate, p - dp)) / (2.0 * dp);
        // truncation 1e-10 of the third derivative; rounding 1e-16 / 1e-5 of stress over step
        EXPECT_NEAR(response.by_shear_rate, by_rate, 1e-9 * (response.stress / rate));
        EXPECT_NEAR(response.by_pressure, by_pressure, 1e-9 * (response.stress / p));
        EXPECT_GT(response.by_shear_rate, 0.0);
      }
}

TEST(LawFamilies, InverseGivesBackTheShearRateAndItsState) {
  const GrainProperties soft{.stiffness = 2e3, .adhesion = 0.5};
  for (const MuPhi& law : families())
    for (const double p : {0.5, 9.0}) {
      const double tau = stress_response(law, soft, 0.3, p).stress;
      const LocalFlow flow = local_flow(law, soft, tau, p);
      EXPECT_EQ(flow.state, LocalState::flows);
      EXPECT_NEAR(flow.shear_rate, 0.3, 1e-13);
      EXPECT_NEAR(flow.inertial_number, 0.3 / std::sqrt(p), 1e-13);
      EXPECT_NEAR(flow.volume_fraction,
                  volume_fraction(law, flow.inertial_number, confinement(soft, p)),
                  1e-14);
    }
}

TEST(LawFamilies, NameEveryStateAPointCanBeIn) {
  const MuPhi law = frictional_spheres();
  const auto state = [&](double mu, const GrainProperties& grains) {
    return local_flow(law, grains, 2.0 * mu, 2.0).state;
  };
  EXPECT_EQ(state(0.35, {}), LocalState::rests);
  EXPECT_EQ(state(0.45, {}), LocalState::flows);
  EXPECT_EQ(state(0.70, {}), LocalState::no_dense_state);
  EXPECT_EQ(state(0.72, {}), LocalState::no_steady);
  EXPECT_EQ(state(0.45, {.stiffness = 5.0}), LocalState::no_friction);  // p* = 0.4 > p_mu
  EXPECT_EQ(name(LocalState::no_friction), "no friction");
}

TEST(LawFamilies, PowerLawOfExponentOneIsTheLinearLaw) {
  MuPhi power = frictional_spheres();
  MuPhi plain = power;
  power.friction.exponent = 1.0;
  for (const double tau : {0.8, 1.2})
    EXPECT_EQ(local_flow(power, {}, tau, 2.0).shear_rate,
              local_flow(plain, {}, tau, 2.0).shear_rate);
}

TEST(LawFamilies, AdditiveCohesionIsAYieldStressWithoutPressure) {
  MuPhi law = incompressible_spheres();
  law.cohesion_stress = CohesionStress{.factor = 0.4};
  const FlowCurve curve = flow_curve(law, {.adhesion = 5.0}, 1e-12);
  EXPECT_NEAR(curve.yield_stress, 2.0, 1e-11);
  EXPECT_EQ(flow_curve(law, {}, 3.0).yield_stress, 3.0 * 0.3530);  // no adhesion, no cohesion
}

MuPhi with_cohesion(const CohesionStress& cohesion) {
  MuPhi law = incompressible_spheres();
  law.cohesion_stress = cohesion;
  return law;
}

TEST(LawFamilies, PowersOfBoAndSoftnessOfExponentsOneAndZeroAreTheAdditiveStress) {
  const MuPhi plain = with_cohesion({.factor = 0.4});
  const MuPhi power =
      with_cohesion({.factor = 0.4, .bond_exponent = 1.0, .softness_exponent = 0.0});
  for (const GrainProperties& grains :
       {GrainProperties{.adhesion = 2.0}, {.stiffness = 2e3, .adhesion = 2.0}})
    for (const double p : {0.01, 3.0, 60.0}) {  // Bo beyond and below 5
      const double expected = flow_curve(plain, grains, p).yield_stress;
      EXPECT_NEAR(flow_curve(power, grains, p).yield_stress, expected, 4e-16 * expected);
    }
}

/// tau_c = factor (f_a / d^2)^b (d / k_n)^g p^(1 - b + g) up to Bo = 5. Beyond, with p* = f_a / (Bo
/// d k_n), factor p p*^g (5^b + b 5^(b-1) (Bo - 5)) tends to factor b 5^(b-1) (f_a / d^2) p*^g.
TEST(LawFamilies, CohesiveStressIsAPowerOfPressureAndVanishesAtAFreeSurface) {
  const double b = 1.44, g = 0.67, k = 2e3, f_a = 3.0;
  const MuPhi law = with_cohesion({.factor = 1.5, .bond_exponent = b, .softness_exponent = g});
  const auto cohesion = [&](double p) {
    return flow_curve(law, {.stiffness = k, .adhesion = f_a}, p).yield_stress - 0.3530 * p;
  };
  for (const double p : {0.7, 5.0, 60.0}) {
    const double exact = 1.5 * std::pow(f_a, b) * std::pow(k, -g) * std::pow(p, 1.0 - b + g);
    EXPECT_NEAR(cohesion(p), exact, 1e-15 * (p + exact));
  }
  for (const double p : {1e-8, 1e-12}) {
    const double limit = 1.5 * b * std::pow(5.0, b - 1.0) * f_a * std::pow(p / k, g);
    EXPECT_NEAR(cohesion(p), limit, 5.0 * p / f_a * limit);  // the constant part of the tangent
  }
}

TEST(LawFamilies, RigidGrainsHaveNoCohesionThatFadesWithSoftness) {
  const GrainProperties rigid{.adhesion = 3.0};
  const double plain = flow_curve(incompressible_spheres(), rigid, 2.0).yield_stress;
  EXPECT_EQ(flow_curve(with_cohesion({.factor = 1.5, .softness_exponent = 0.67}), rigid, 2.0)
                .yield_stress,
            plain);
  EXPECT_NEAR(  // and the limit k_n -> infinity is that one: (p / k_n)^g of c0 = 4.5
      flow_curve(with_cohesion({.factor = 1.5, .softness_exponent = 0.5}),
                 {.stiffness = 2e30, .adhesion = 3.0},
                 2.0)
          .yield_stress,
      plain + 4.5e-15,
      1e-15);
  EXPECT_EQ(
      flow_curve(with_cohesion({.factor = 1.5, .softness_exponent = 0.0}), rigid, 2.0).yield_stress,
      flow_curve(with_cohesion({.factor = 1.5}), rigid, 2.0).yield_stress);
}

TEST(FlowCurve, NoRateReachesTheLargestFriction) {
  const FlowCurve curve = flow_curve(frictional_spheres(), {}, 2.0);
  EXPECT_FALSE(curve.relative_inertial_number(2.0 * 0.7149));
  EXPECT_FALSE(curve.scaled_rate(2.0 * 0.70));  // I_phi comes first
  EXPECT_GT(curve.relative_inertial_number(2.0 * 0.70).value(), 1.0);
}

/// Shi et al. 2020, tables 3, 5 and 7 put into eqs. 16 and 1A: I = 0.02, p* = 0.01, four digits.
TEST(PublishedLaws, GiveTheFrictionTheirCoefficientsGive) {
  const auto at = [](double Bo) {
    return Confinement{.softness = (1.0 + Bo) * 0.01, .bond_number = Bo};
  };
  EXPECT_NEAR(friction(frictional_spheres(), 0.02, at(0.0)), 0.3047, 5e-5);
  EXPECT_NEAR(friction(frictional_spheres(), 0.02, at(1.0)), 0.3523, 5e-5);
  EXPECT_NEAR(friction(frictional_spheres(), 0.02, at(5.0)), 0.8625, 5e-5);
  EXPECT_NEAR(friction(slippery_spheres(), 0.02, at(2.0)), 0.3467, 5e-5);
  EXPECT_NEAR(volume_fraction(frictional_spheres(), 0.02, at(0.0)), 0.6134, 5e-5);
  EXPECT_NEAR(volume_fraction(slippery_spheres(), 0.02, at(0.0)), 0.6710, 5e-5);
  EXPECT_NEAR(volume_fraction(slippery_spheres(), 0.02, at(5.0)), 0.723986, 5e-7);
}

TEST(PublishedLaws, StayPhysicalBeyondTheFittedBondNumbers) {
  for (const auto& law : {frictional_spheres(), slippery_spheres()}) {
    double previous = 0.0;
    for (const double Bo : {1.0, 4.999999, 5.0, 5.000001, 7.0, 20.0, 1e6}) {
      const double f_B = friction_factor(law, {.softness = 0.0, .bond_number = Bo});
      EXPECT_GE(f_B, previous);
      previous = f_B;
      EXPECT_GT(static_volume_fraction(law, {.softness = 0.0, .bond_number = Bo}), 0.5);
    }
  }
}

TEST(PublishedLaws, KeepAFiniteYieldStressAtAFreeSurface) {
  const MuPhi law = frictional_spheres();
  const double f_a = 5.0;
  // tangent of f_B: tau_y -> mu0 alpha beta 5^(beta-1) f_a as p -> 0
  const double limit = 0.3530 * 0.2551 * 1.5125 * std::pow(5.0, 0.5125) * f_a;
  EXPECT_NEAR(flow_curve(law, {.adhesion = f_a}, 1e-12).yield_stress, limit, 1e-10 * limit);
}

TEST(RigidGrains, HaveExactlyTheFrictionWithoutSoftness) {
  MuPhi without = frictional_spheres();
  without.softness_friction.reset();
  EXPECT_EQ(flow_curve(frictional_spheres(), {}, 7.0).yield_stress,
            flow_curve(without, {}, 7.0).yield_stress);
}

}  // namespace
}  // namespace grainlaw::continuum
