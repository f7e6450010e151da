#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

Outcome outcome(const RheologyTable& table, const ChuteCase& chute) {
  const auto steady = steady_chute(table, chute);
  EXPECT_EQ(steady.profile.rows.empty(), !flows(steady.answer.outcome)) << steady.answer.text;
  EXPECT_FALSE(steady.answer.text.empty());
  return steady.answer.outcome;
}

const RheologyTable frictional = table_of(frictional_spheres());

TEST(SteadyChute, RestsBelowReposeAndFlowsAboveIt) {  // repose atan 0.3530 = 19.443 degrees
  for (const double theta : {15.0, 18.0, 19.0, 19.4, 19.44})
    EXPECT_EQ(outcome(frictional, chute(theta, 52.2)), Outcome::arrested) << theta;
  for (const double theta : {19.45, 19.5, 24.0, 33.0, 33.9})
    EXPECT_EQ(outcome(frictional, chute(theta, 52.2)), Outcome::steady) << theta;
}

TEST(SteadyChute, HasNoDenseStateBetweenThePhiLimitAndTheLargestFriction) {
  for (const double theta : {33.95, 34.5, 35.0, 35.5})
    EXPECT_EQ(outcome(frictional, chute(theta, 52.2)), Outcome::no_dense_state) << theta;
  for (const double theta : {36.0, 40.0})
    EXPECT_EQ(outcome(frictional, chute(theta, 52.2)), Outcome::no_steady) << theta;
}

TEST(SteadyChute, SoftGrainsHaveAGreatestDepth) {
  const GrainProperties soft{.stiffness = 3819.718634};
  EXPECT_EQ(outcome(frictional, chute(30, 52.2, soft)), Outcome::no_dense_state);
  EXPECT_EQ(outcome(frictional, chute(33, 52.2, soft)), Outcome::no_steady);
  EXPECT_EQ(outcome(frictional, chute(24, 52.2, {.stiffness = 1047.2})), Outcome::no_dense_state);
}

TEST(SteadyChute, RefusesALawWhoseFrictionSoftnessHasTaken) {
  const auto steady = steady_chute(frictional, chute(24, 52.2, {.stiffness = 100.0}));
  EXPECT_EQ(steady.answer.outcome, Outcome::no_steady);
  EXPECT_NE(steady.answer.text.find("f_p <= 0"), std::string::npos) << steady.answer.text;
}

TEST(SteadyChute, JustAboveReposeHasTheShearRateOfTheClosedForm) {
  for (const double theta : {19.45, 19.5}) {
    const double excess = std::tan(theta * degree) - 0.3530;
    const double I = 0.7184 * excess / (0.7148 - std::tan(theta * degree));
    const auto steady = steady_chute(frictional, chute(theta, 52.2));
    // tan - mu0 keeps 12 digits or more
    EXPECT_NEAR(steady.profile.rows.front().inertial_number, I, 1e-11 * I);
    EXPECT_NEAR(steady.answer.condition_number,
                std::tan(theta * degree) / excess * (1.0 + I / 0.7184),
                1e-9 * steady.answer.condition_number);
  }
}

/// The tilt and its neighbours among the numbers a computer has.
std::vector<double> tilts_about(double inclination) {
  std::vector<double> tilts{inclination};
  for (int k = 0; k < 60; ++k) tilts.push_back(std::nextafter(tilts.back(), 0.0));
  tilts.push_back(inclination);
  for (int k = 0; k < 60; ++k) tilts.push_back(std::nextafter(tilts.back(), 1.5));
  return tilts;
}

TEST(SteadyChute, AnswersWithinRoundingOfTheLimitsOfTheLaw) {
  const MuPhi dilating = frictional_spheres();
  const InertialFriction& mu = dilating.friction;
  const double largest = mu.mu0 + mu.beta / mu.kappa;
  const double at_I_phi =
      inertial_friction(mu.mu0, mu.beta, mu.kappa, dilating.volume_fraction.I_phi);
  const struct {
    MuPhi law;
    double friction;
  } limits[] = {{dilating, mu.mu0},
                {dilating, at_I_phi},
                {dilating, largest},
                {incompressible_spheres(), largest}};
  for (const auto& [law, friction] : limits) {
    for (const double mass : {0.7, 5.3, 29.0, 52.2}) {
      for (const double inclination : tilts_about(std::atan(friction))) {
        const ChuteCase inclined{.inclination = inclination, .mass_per_area = mass};
        const Outcome flow = outcome(table_of(law), inclined);
        if (friction == mu.mu0) continue;
        ChuteCase walled = inclined;
        walled.walls = SideWalls{.width = 10.0, .friction = 1e-12};
        EXPECT_NO_THROW(steady_chute(table_of(law), walled)) << mass << ' ' << inclination;
        EXPECT_NO_THROW(start_from_rest(table_of(law), inclined, {.cells = 5, .time_limit = 1.0}))
            << name(flow);
      }
    }
  }
}

TEST(SteadyChute, CoulombMaterialHasNoSteadyShear) {
  MuPhi coulomb = incompressible_spheres();
  coulomb.friction = {.mu0 = 0.4};
  EXPECT_EQ(outcome(table_of(coulomb), chute(20, 30)), Outcome::arrested);
  EXPECT_EQ(outcome(table_of(coulomb), chute(24, 30)), Outcome::no_steady);
}

TEST(SteadyChute, FluidWithoutReposeFlowsAtAnyTilt) {
  MuPhi law = incompressible_spheres();
  law.friction = {.mu0 = 0.0, .beta = 1.0, .kappa = 0.0};
  EXPECT_EQ(outcome(table_of(law), chute(0.01, 30)), Outcome::steady);
  EXPECT_EQ(outcome(table_of(law), chute(0.0, 30)), Outcome::arrested);
}

TEST(SteadyChute, NegativeTiltIsTheMirrorImage) {
  const auto right = steady_chute(frictional, chute(24, 52.2, {.adhesion = 2.0})).profile;
  const auto left = steady_chute(frictional, chute(-24, 52.2, {.adhesion = 2.0})).profile;
  EXPECT_EQ(left.flux, -right.flux);
  EXPECT_EQ(left.plug_mass, right.plug_mass);
  for (std::size_t i = 0; i < right.rows.size(); ++i) {
    EXPECT_EQ(left.rows[i].velocity, -right.rows[i].velocity);
    EXPECT_EQ(left.rows[i].shear_stress, -right.rows[i].shear_stress);
    EXPECT_EQ(left.rows[i].shear_rate, -right.rows[i].shear_rate);
    EXPECT_EQ(left.rows[i].z, right.rows[i].z);
  }
}

TEST(SteadyChute, RefusesCasesWithoutMeaning) {
  EXPECT_THROW(steady_chute(frictional, chute(90, 52.2)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(-90, 52.2)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, 0.0)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, NAN)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, 1e-300)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, 1e300)), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, 50, {.stiffness = -1.0})), std::invalid_argument);
  EXPECT_THROW(steady_chute(frictional, chute(24, 50), {.rows = 1}), std::invalid_argument);
  EXPECT_THROW(steady_chute(table_of(bagnold_at_24_degrees(0, 0, 0)), chute(24, 50)), TableError);
}

TEST(SteadyChute, ThickensItsPlugWithTheAdhesion) {
  double previous = 0.0;
  for (const double f_a : {1e-6, 1e-3, 0.1, 1.0, 5.0, 10.0}) {
    const auto steady = steady_chute(frictional, chute(24, 52.2, {.adhesion = f_a}));
    EXPECT_EQ(steady.answer.outcome, Outcome::plug);
    EXPECT_GT(steady.profile.plug_mass, previous);
    previous = steady.profile.plug_mass;
  }
  EXPECT_EQ(outcome(frictional, chute(24, 52.2, {.adhesion = 100.0})), Outcome::arrested);
}

TEST(SteadyChute, ThinAndVeryDeepLayersHaveTheSameInertialNumber) {
  for (const double mass : {0.5, 1e5}) {
    const auto steady = steady_chute(frictional, chute(24, mass));
    EXPECT_NEAR(steady.profile.rows.front().inertial_number, 0.2457868620, 1e-10);
  }
}

TEST(SteadyChute, GivesTheSameAnswerInSiUnits) {
  // glass of 100 um; stiffness and adhesion as multiples of rho_p g d^2 and rho_p g d^3
  const double d = 1e-4, rho = 2500.0, g = 9.81, stress = rho * g * d;
  const GrainProperties unit{.stiffness = 5.2e3, .adhesion = 2.0};
  const GrainProperties glass{.diameter = d,
                              .density = rho,
                              .stiffness = 5.2e3 * stress * d,
                              .adhesion = 2.0 * stress * d * d};
  const auto plain = steady_chute(frictional, chute(24, 52.2, unit));
  const auto si = steady_chute(
      frictional,
      {.inclination = 24 * degree, .gravity = g, .mass_per_area = 52.2 * rho * d, .grains = glass});
  ASSERT_EQ(plain.profile.rows.size(), si.profile.rows.size());
  for (std::size_t i = 1; i < plain.profile.rows.size(); ++i) {
    const auto& x = plain.profile.rows[i];
    const auto& y = si.profile.rows[i];
    EXPECT_NEAR(y.velocity / std::sqrt(g * d) / x.velocity, 1.0, 1e-12);
    EXPECT_NEAR(y.z / d / x.z, 1.0, 1e-12);
    EXPECT_NEAR(y.volume_fraction, x.volume_fraction, 1e-12);
    EXPECT_NEAR(y.shear_stress / stress, x.shear_stress, 1e-12 * 30);
  }
}

TEST(SteadyChute, BagnoldCoefficientsScaleWithTheUnits) {
  const double d = 2e-3, rho = 1500.0, g = 3.7, time = std::sqrt(d / g), stress = rho * g * d;
  auto law = bagnold_at_24_degrees(1.3, 0.8, 6.0);
  const double velocity = steady_chute(table_of(law), chute(24, 29)).profile.surface_velocity;
  law.a *= stress * time * time;
  law.b *= stress * time;
  law.tau_c *= stress;
  const auto si = steady_chute(table_of(law),
                               {.inclination = 24 * degree,
                                .gravity = g,
                                .mass_per_area = 29 * rho * d,
                                .grains = {.diameter = d, .density = rho}});
  EXPECT_NEAR(si.profile.surface_velocity / std::sqrt(g * d), velocity, 1e-12 * velocity);
}

TEST(SteadyChute, CutsTheDomainAtTheEffectiveBase) {
  auto table = frictional;
  table.base = EffectiveBase{.no_slip_height = 1.1, .mass_below = 0.6, .recipe = {}};
  const auto cut = steady_chute(table, chute(24, 52.8)).profile;
  const auto whole = steady_chute(frictional, chute(24, 52.2)).profile;
  EXPECT_EQ(cut.rows.front().z, 1.1);
  EXPECT_EQ(cut.rows.front().velocity, 0.0);
  // 52.8 - 0.6 differs from 52.2 in the last digit
  EXPECT_NEAR(cut.rows.front().mass_above, 52.2, 1e-13);
  EXPECT_NEAR(cut.surface_velocity, whole.surface_velocity, 1e-11);
  EXPECT_NEAR(cut.height, whole.height + 1.1, 1e-11);
  try {
    steady_chute(table, chute(24, 0.6));
    FAIL() << "flows below its base";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("more than 0.6"), std::string::npos) << error.what();
  }
}

TEST(SteadyChute, ReducesToTheSimplerLawWhenAParameterVanishes) {
  MuPhi simple = frictional_spheres();
  simple.softness_friction.reset();
  simple.softness_volume_fraction.reset();
  simple.cohesion_friction.reset();
  simple.cohesion_volume_fraction.reset();
  const double velocity = steady_chute(table_of(simple), chute(24, 52.2)).profile.surface_velocity;
  for (const auto& grains : {GrainProperties{}, GrainProperties{.adhesion = 0.0}})
    EXPECT_NEAR(steady_chute(frictional, chute(24, 52.2, grains)).profile.surface_velocity,
                velocity,
                1e-12 * velocity);
}

TEST(SteadyChute, FluxIsTheVolumeOfGrainsPassing) {
  const auto profile =
      steady_chute(frictional, chute(24, 52.2, {.stiffness = 3.8e4}), {.rows = 2001}).profile;
  double flux = 0.0;  // trapezoid in mass, int u dM / rho_p
  for (std::size_t i = 1; i < profile.rows.size(); ++i)
    flux += 0.5 * (profile.rows[i].velocity + profile.rows[i - 1].velocity) *
            (profile.rows[i - 1].mass_above - profile.rows[i].mass_above);
  EXPECT_NEAR(profile.flux, flux, profile.flux / 2000.0 / 2000.0);
}

const RangeFlag* find(const Answer& answer, const std::string& quantity) {
  for (const auto& flag : answer.out_of_domain)
    if (flag.quantity == quantity) return &flag;
  return nullptr;
}

TEST(RangeFlags, AreAbsentInsideTheRange) {
  auto table = frictional;
  table.range = {.inertial_number = Range{0.005, 0.5}, .softness = Range{0.0, 0.1}};
  EXPECT_TRUE(
      steady_chute(table, chute(24, 52.2, {.stiffness = 3.8e5})).answer.out_of_domain.empty());
}

TEST(RangeFlags, NameTheWholeFlowWhenTheInertialNumberIsOutside) {
  auto table = frictional;
  table.range.inertial_number = Range{0.005, 0.2};
  const auto answer = steady_chute(table, chute(24, 52.2)).answer;
  const auto* flag = find(answer, "I");
  ASSERT_NE(flag, nullptr);
  EXPECT_NEAR(flag->reached_highest, 0.245787, 1e-6);
  EXPECT_DOUBLE_EQ(flag->fraction_outside, 1.0);
}

TEST(RangeFlags, AreAbsentWhereTheFlowEndsWithItsDataUpToRounding) {
  auto table = frictional;
  const auto rows = steady_chute(table, chute(24, 52.2, {.stiffness = 3.8e5})).profile.rows;
  double highest = 0.0;
  for (const auto& row : rows) highest = std::max(highest, row.inertial_number);
  table.range.inertial_number = Range{0.005, highest * (1.0 - 1e-12)};
  EXPECT_EQ(find(steady_chute(table, chute(24, 52.2, {.stiffness = 3.8e5})).answer, "I"), nullptr);
  table.range.inertial_number = Range{0.005, highest * (1.0 - 1e-6)};
  EXPECT_NE(find(steady_chute(table, chute(24, 52.2, {.stiffness = 3.8e5})).answer, "I"), nullptr);
}

TEST(RangeFlags, CountOnlyTheFlowingMassForTheBondNumber) {
  auto table = frictional;
  table.range.bond_number = Range{0.0, 0.5};
  const auto steady = steady_chute(table, chute(24, 52.2, {.adhesion = 5.0}));
  const auto* flag = find(steady.answer, "Bo");
  ASSERT_NE(flag, nullptr);
  const double outside = 5.0 / 0.5 / std::cos(24 * degree);  // mass above p = f_a / 0.5
  const double plug = steady.profile.plug_mass;
  EXPECT_NEAR(flag->fraction_outside, (outside - plug) / (52.2 - plug), 0.01);  // 100 row intervals
}

TEST(RangeFlags, NameCohesiveGrainsOnALawWithoutCohesion) {
  MuPhi law = frictional_spheres();
  law.cohesion_friction.reset();
  const auto answer = steady_chute(table_of(law), chute(24, 52.2, {.adhesion = 0.1})).answer;
  ASSERT_NE(find(answer, "Bo"), nullptr);
  EXPECT_DOUBLE_EQ(find(answer, "Bo")->fraction_outside, 1.0);
}

TEST(RangeFlags, NameCohesionThatRigidGrainsLose) {
  MuPhi law = incompressible_spheres();
  law.cohesion_stress =
      CohesionStress{.factor = 1.5, .bond_exponent = 1.2, .softness_exponent = 0.5};
  RheologyTable table = table_of(law);
  table.range = {.softness = Range{1e-3, 1e-2}, .bond_number = Range{0.0, 5.0}};
  const auto flags = [&](const GrainProperties& grains) {
    return steady_chute(table, chute(24, 29, grains)).answer.out_of_domain;
  };
  ASSERT_EQ(flags({.adhesion = 0.1}).size(), 1U);
  EXPECT_EQ(flags({.adhesion = 0.1})[0].quantity, "p*");
  EXPECT_EQ(flags({.adhesion = 0.1})[0].reached_highest, 0.0);
  EXPECT_TRUE(flags({}).empty());  // nothing to lose
}

TEST(RangeFlags, NameADiluteFlow) {
  const auto answer = steady_chute(frictional, chute(33, 52.2)).answer;
  ASSERT_NE(find(answer, "phi"), nullptr);
  EXPECT_LT(find(answer, "phi")->reached_lowest, 0.5);
}

TEST(RangeFlags, NameALayerOfAFewGrains) {
  const auto thin = steady_chute(frictional, chute(24, 2.0));
  ASSERT_NE(find(thin.answer, "depth [d]"), nullptr);
  EXPECT_EQ(find(thin.answer, "depth [d]")->reached_lowest, thin.profile.height);
  EXPECT_EQ(find(steady_chute(frictional, chute(24, 3.0)).answer, "depth [d]"), nullptr);
  EXPECT_TRUE(steady_chute(frictional, chute(15, 2.0)).answer.out_of_domain.empty());  // rests
}

TEST(RangeFlags, BagnoldTableIsValidAtItsOwnTiltOnly) {
  const auto table = table_of(bagnold_at_24_degrees(1.3, 0.8, 0.0));
  EXPECT_EQ(find(steady_chute(table, chute(24, 29)).answer, "inclination"), nullptr);
  const auto other = steady_chute(table, chute(26, 29));
  EXPECT_EQ(other.answer.outcome, Outcome::steady);
  ASSERT_NE(find(other.answer, "inclination"), nullptr);
  EXPECT_NEAR(find(other.answer, "inclination")->reached_highest, 26 * degree, 1e-15);
}

}  // namespace
}  // namespace grainlaw::continuum
