#include "calibration/material_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/calibration_checks.h"
#include "support/synthetic_states.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;
using testing::mentions;
using testing::StateGrid;
using testing::states;

/// Rows of tables 3, 5 and 7 of Shi et al. 2020 for mu_p = 0, 0.01 and 0.5.
continuum::MuPhi published(double mu0,
                           double mu_inf,
                           double I_mu,
                           double p_mu,
                           double alpha,
                           double beta,
                           continuum::InertialVolumeFraction phi,
                           double p_phi,
                           continuum::CohesionVolumeFraction g_c) {
  continuum::MuPhi law;
  law.friction = {.mu0 = mu0, .beta = (mu_inf - mu0) / I_mu, .kappa = 1.0 / I_mu};
  law.softness_friction = continuum::SoftnessFriction{.p_mu = p_mu};
  law.cohesion_friction = continuum::CohesionFriction{.alpha = alpha, .beta = beta};
  law.volume_fraction = phi;
  law.softness_volume_fraction = continuum::SoftnessVolumeFraction{.p_phi = p_phi};
  law.cohesion_volume_fraction = g_c;
  return law;
}

const std::vector<continuum::MuPhi> published_laws{published(0.1432,
                                                             0.3281,
                                                             0.0645,
                                                             0.4222,
                                                             0.3136,
                                                             1.6475,
                                                             {0.656, 1.960},
                                                             0.271,
                                                             {-0.0175, -0.0060, 0.0029, -0.0003}),
                                                   published(0.1645,
                                                             0.3499,
                                                             0.0818,
                                                             0.4950,
                                                             0.4490,
                                                             1.5218,
                                                             {0.653, 2.246},
                                                             0.272,
                                                             {-0.0237, -0.0056, 0.0034, -0.0004}),
                                                   published(0.3530,
                                                             0.7148,
                                                             0.7184,
                                                             0.3905,
                                                             0.2551,
                                                             1.5125,
                                                             {0.595, 5.383},
                                                             0.287,
                                                             {-0.1359, 0.0668, -0.0162, 0.0015})};
const continuum::MuPhi& frictional = published_laws[2];

/// The control grid of Shi et al. 2020, table 2, as far as both laws are claimed to hold.
const StateGrid grid{.inertial_numbers = {0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4},
                     .softnesses = {0.0025, 0.005, 0.01, 0.02},
                     .bond_numbers = {0, 0.1, 0.5, 1, 2, 3, 5}};
const StateGrid cohesionless{
    .inertial_numbers = grid.inertial_numbers, .softnesses = grid.softnesses, .bond_numbers = {0}};

const continuum::MuPhi& law_of(const MaterialFit& fit) {
  return std::get<continuum::MuPhi>(fit.table.law);
}

const FittedCoefficient& derived(const FitSummary& summary, const std::string& name) {
  for (const FittedCoefficient& c : summary.derived) {
    if (c.name == name) return c;
  }
  throw std::out_of_range(name);
}

TEST(MaterialFit, PublishedLawsComeBackFromExactStates) {
  for (const continuum::MuPhi& truth : published_laws) {
    const MaterialFit fit = fit_material(states(truth, grid));
    const continuum::MuPhi& law = law_of(fit);
    EXPECT_NEAR(law.friction.mu0, truth.friction.mu0, 1e-7);
    EXPECT_NEAR(law.friction.kappa, truth.friction.kappa, 1e-6 * truth.friction.kappa);
    ASSERT_TRUE(law.softness_friction && law.cohesion_friction);
    EXPECT_NEAR(law.softness_friction->p_mu, truth.softness_friction->p_mu, 1e-6);
    EXPECT_NEAR(law.cohesion_friction->alpha, truth.cohesion_friction->alpha, 1e-6);
    EXPECT_NEAR(law.cohesion_friction->beta, truth.cohesion_friction->beta, 1e-6);
    EXPECT_NEAR(law.volume_fraction.I_phi, truth.volume_fraction.I_phi, 1e-6);
    EXPECT_NEAR(law.softness_volume_fraction->p_phi, truth.softness_volume_fraction->p_phi, 1e-6);
    const continuum::Confinement strong{.softness = 0.06, .bond_number = 5.0};
    EXPECT_NEAR(continuum::volume_fraction(law, 0.1, strong),
                continuum::volume_fraction(truth, 0.1, strong),
                1e-7);
    EXPECT_NEAR(derived(fit.friction, "mu_inf").value,
                truth.friction.mu0 + truth.friction.beta / truth.friction.kappa,
                1e-6);
    EXPECT_NO_THROW(continuum::validate(fit.table));
  }
}

/// Four standard errors: one false alarm in 16 000 for each coefficient.
void expect_within_errors(const FittedCoefficient& c, double truth) {
  EXPECT_NEAR(c.value, truth, 4.0 * c.error) << c.name;
}

TEST(MaterialFit, PublishedLawsComeBackWithinTheirErrorsFromNoisyStates) {
  for (const continuum::MuPhi& truth : published_laws) {
    const MaterialFit fit = fit_material(
        states(truth, grid, {.friction = 0.02, .volume_fraction = 0.003, .inertial_number = 0.01}));
    continuum::RheologyTable expected;
    expected.law = truth;
    for (const FittedCoefficient& c : fit.friction.coefficients) {
      expect_within_errors(c, continuum::coefficient(expected, c.name));
    }
    EXPECT_EQ(fit.friction.coefficients.size(), 6u);  // every term of the truth is measured
    expect_within_errors(fit.volume_fraction["phi0"], truth.volume_fraction.phi0);
    expect_within_errors(fit.volume_fraction["I_phi"], truth.volume_fraction.I_phi);
    expect_within_errors(fit.volume_fraction["p_phi"], truth.softness_volume_fraction->p_phi);
    EXPECT_NO_THROW(continuum::validate(fit.table));
  }
}

TEST(MaterialFit, RigidCohesionlessGrainsHaveNoColumnsForSoftnessAndCohesion) {
  const StateGrid rigid{
      .inertial_numbers = grid.inertial_numbers, .softnesses = {0}, .bond_numbers = {0}};
  const MaterialFit fit =
      fit_material(states(frictional, rigid, {.friction = 0.002, .volume_fraction = 0.001}));
  EXPECT_FALSE(law_of(fit).softness_friction || law_of(fit).cohesion_friction);
  EXPECT_FALSE(law_of(fit).softness_volume_fraction || law_of(fit).cohesion_volume_fraction);
  EXPECT_TRUE(mentions(fit.friction.left_out, "f_p (softness) is dropped: it needs 2 different"));
  EXPECT_TRUE(mentions(fit.friction.left_out, "f_B (cohesion) is dropped"));
  EXPECT_EQ(fit.table.provenance.source.find("f_"), std::string::npos);
  EXPECT_FALSE(fit.table.range.bond_number || fit.table.range.softness);
  EXPECT_EQ(fit.table.covariance->names,
            (std::vector<std::string>{"mu0", "beta", "kappa", "phi0", "I_phi"}));
}

TEST(MaterialFit, TermsThatTheMaterialDoesNotHaveAreDroppedNineteenTimesInTwenty) {
  continuum::MuPhi plain;
  plain.friction = {.mu0 = 0.35, .beta = 0.5};
  plain.volume_fraction = {.phi0 = 0.6, .I_phi = 5.0};
  int kept = 0, terms = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const MaterialFit fit = fit_material(
        states(plain, cohesionless, {.friction = 0.01, .volume_fraction = 0.003, .seed = seed}));
    kept += law_of(fit).friction.kappa > 0.0 ? 1 : 0;
    kept += law_of(fit).softness_friction ? 1 : 0;
    kept += law_of(fit).softness_volume_fraction ? 1 : 0;
    terms += 3;
  }
  // Kept by chance: 5 % at most, half of that where a bound forbids the other sign.
  EXPECT_LE(kept, 0.05 * terms + 3.0 * std::sqrt(0.05 * 0.95 * terms));
}

TEST(MaterialFit, AdditiveCohesionIsToldFromAFactor) {
  continuum::MuPhi additive = frictional;
  additive.cohesion_friction.reset();
  additive.cohesion_stress = continuum::CohesionStress{.factor = 0.2};
  const MaterialFit fit =
      fit_material(states(additive, grid, {.friction = 0.01, .volume_fraction = 0.003}));
  ASSERT_EQ(fit.families.size(), 12u);
  ASSERT_TRUE(law_of(fit).cohesion_stress);
  EXPECT_FALSE(law_of(fit).cohesion_friction);
  expect_within_errors(fit.friction["cohesion_factor"], 0.2);
  EXPECT_TRUE(mentions(fit.friction.notes, "tau = c0 + mu p"));
  const MaterialFit published =
      fit_material(states(frictional, grid, {.friction = 0.01, .volume_fraction = 0.003}));
  EXPECT_TRUE(law_of(published).cohesion_friction);
}

continuum::MuPhi with_power_of_softness() {
  continuum::MuPhi law = frictional;
  law.cohesion_friction.reset();
  law.cohesion_stress =
      continuum::CohesionStress{.factor = 1.5, .bond_exponent = 1.44, .softness_exponent = 0.67};
  return law;
}

TEST(MaterialFit, CohesionThatFadesWithSoftnessComesBackFromExactStates) {
  const MaterialFit fit = fit_material(states(with_power_of_softness(), grid));
  const auto& cohesion = law_of(fit).cohesion_stress;
  ASSERT_TRUE(cohesion && cohesion->bond_exponent && cohesion->softness_exponent);
  EXPECT_NEAR(cohesion->factor, 1.5, 1e-5);
  EXPECT_NEAR(*cohesion->bond_exponent, 1.44, 1e-6);
  EXPECT_NEAR(*cohesion->softness_exponent, 0.67, 1e-6);
}

TEST(MaterialFit, CohesionThatFadesWithSoftnessIsFoundWithinItsErrors) {
  const MaterialFit fit = fit_material(
      states(with_power_of_softness(), grid, {.friction = 0.01, .volume_fraction = 0.003}));
  EXPECT_TRUE(mentions(fit.friction.notes, "+ factor Bo^b p*^g"));
  expect_within_errors(fit.friction["cohesion_factor"], 1.5);
  expect_within_errors(fit.friction["cohesion_bond_exponent"], 1.44);
  expect_within_errors(fit.friction["cohesion_softness_exponent"], 0.67);
  const auto& names = fit.table.covariance->names;
  EXPECT_EQ(std::count(names.begin(), names.end(), "cohesion_softness_exponent"), 1);
}

TEST(MaterialFit, OnePressureWithCohesionDoesNotTellHowItFadesWithSoftness) {
  auto points = states(with_power_of_softness(), cohesionless, {.friction = 0.01});
  const StateGrid one{.inertial_numbers = grid.inertial_numbers,
                      .softnesses = {0.01},
                      .bond_numbers = grid.bond_numbers};
  for (const auto& point : states(with_power_of_softness(), one, {.friction = 0.01, .seed = 2})) {
    points.push_back(point);
  }
  const MaterialFit fit = fit_material(points);
  ASSERT_EQ(fit.families.size(), 8u);
  EXPECT_FALSE(law_of(fit).cohesion_stress && law_of(fit).cohesion_stress->softness_exponent);
}

TEST(MaterialFit, PlateauBeyondTheDataHasAnOpenInterval) {
  // I up to 0.1 at 1 % noise: kappa is half a standard error (24 points along I alone).
  StateGrid slow{.inertial_numbers = {}, .softnesses = {0}, .bond_numbers = {0}};
  for (int i = 0; i < 24; ++i) {
    slow.inertial_numbers.push_back(0.005 * std::pow(20.0, i / 23.0));
  }
  int open = 0, linear = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MaterialFit fit = fit_material(
        states(frictional, slow, {.friction = 0.01, .volume_fraction = 0.003, .seed = seed}));
    if (fit.friction.coefficients.size() == 2) {
      ++linear;
    } else {
      const Interval& mu_inf = derived(fit.friction, "mu_inf").interval;
      EXPECT_TRUE(mu_inf.by_profile);
      open += mu_inf.upper > 2.0 ? 1 : 0;
      EXPECT_LT(mu_inf.lower, 0.7148);
    }
  }
  EXPECT_GE(linear, 10);  // the chance to see kappa at 2 standard errors is 7 %
}

// Points that scatter by ten times their stated errors: all errors grow to match, and an interval
// of 95 % still holds the value and one error to either side.
TEST(MaterialFit, PlateauHasAWideIntervalWhereTheLawMissesThePoints) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    auto points = states(frictional, cohesionless, {.friction = 0.012, .seed = seed});
    for (StatePoint& point : points) point.friction.error /= 10.0;
    const FittedCoefficient mu_inf = derived(fit_material(points).friction, "mu_inf");
    EXPECT_LT(mu_inf.interval.lower, mu_inf.value - mu_inf.error);
    EXPECT_GT(mu_inf.interval.upper, mu_inf.value + mu_inf.error);
  }
}

TEST(MaterialFit, PointsOutsideTheRangeAreLeftOutWeighLessOrStay) {
  StateGrid wide = cohesionless;
  wide.inertial_numbers.push_back(0.8);
  auto points = states(frictional, wide, {.friction = 0.01, .volume_fraction = 0.003});
  points[7].friction.value *= 1.3;  // where the law does not hold
  MaterialFitOptions options;
  const MaterialFit out = fit_material(points, options);
  EXPECT_TRUE(mentions(out.friction.left_out, "point 8 is left out: I = 0.8 is above 0.5"));
  EXPECT_EQ(out.friction_weight[7], 0.0);
  options.range.outside = OutOfRange::weigh_less;
  const MaterialFit less = fit_material(points, options);
  EXPECT_GT(less.friction_weight[7], 0.0);
  EXPECT_LT(less.friction_weight[7], 0.5);
  EXPECT_EQ(less.friction_weight[0], 1.0);
  EXPECT_TRUE(mentions(less.friction.notes, "point 8 is outside the range of the law and kept"));
  options.range.outside = OutOfRange::keep;
  EXPECT_EQ(fit_material(points, options).friction_weight[7], 1.0);
}

TEST(MaterialFit, RowsThatAreNoNumbersOrTwiceThereAreNamed) {
  auto points = states(frictional, cohesionless, {.friction = 0.01, .volume_fraction = 0.003});
  points.push_back(points[3]);
  points[0].friction.value = std::numeric_limits<double>::quiet_NaN();
  points[1].inertial_number.value = std::numeric_limits<double>::infinity();
  const MaterialFit fit = fit_material(points);
  EXPECT_TRUE(mentions(fit.friction.left_out, "point 1 is left out: the measured value"));
  EXPECT_TRUE(mentions(fit.friction.left_out, "point 2 is left out: I is not a number"));
  EXPECT_TRUE(mentions(fit.friction.left_out, "point 29 is left out: the same numbers"));
}

TEST(MaterialFit, ThreePointsGiveALineAndSaySo) {
  const StateGrid few{.inertial_numbers = {0.01, 0.1, 0.2}, .softnesses = {0}, .bond_numbers = {0}};
  const MaterialFit fit = fit_material(states(frictional, few, {.friction = 0.01}));
  EXPECT_EQ(fit.friction.coefficients.size(), 2u);
  EXPECT_TRUE(mentions(fit.friction.left_out, "kappa is dropped: it needs 4 different values"));
}

TEST(MaterialFit, OnePointIsRefusedWithASentence) {
  const StateGrid one{.inertial_numbers = {0.1}, .softnesses = {0, 0.01}, .bond_numbers = {0}};
  EXPECT_NE(failure([&] { fit_material(states(frictional, one)); }).find("two different I"),
            std::string::npos);
  EXPECT_NE(failure([&] { fit_material({}); }), "");
}

TEST(MaterialFit, SoftnessThatNeverChangesTheFlowIsNotReadOut) {
  // (1 + Bo) p* is the same everywhere: f_p and mu0 cannot be told apart.
  std::vector<StatePoint> points;
  for (const double Bo : {0.0, 1.0, 3.0}) {
    const StateGrid one{.inertial_numbers = grid.inertial_numbers,
                        .softnesses = {0.02 / (1.0 + Bo)},
                        .bond_numbers = {Bo}};
    for (const StatePoint& p :
         states(frictional, one, {.friction = 0.01, .volume_fraction = 0.003})) {
      points.push_back(p);
    }
  }
  const MaterialFit fit = fit_material(points);
  EXPECT_FALSE(law_of(fit).softness_friction);
  EXPECT_TRUE(mentions(fit.friction.left_out, "f_p (softness) is dropped"));
}

TEST(MaterialFit, FrictionThatFallsWithTheInertialNumberEndsAtItsBound) {
  continuum::MuPhi falling;
  falling.friction = {.mu0 = 0.35, .beta = -0.2};
  falling.volume_fraction = {.phi0 = 0.6, .I_phi = 5.0};
  const StateGrid rigid{
      .inertial_numbers = grid.inertial_numbers, .softnesses = {0}, .bond_numbers = {0}};
  const MaterialFit fit =
      fit_material(states(falling, rigid, {.friction = 0.01, .volume_fraction = 0.003}));
  EXPECT_TRUE(fit.friction["beta"].at_bound);
  EXPECT_TRUE(mentions(fit.friction.notes, "beta is at its bound"));
}

TEST(MaterialFit, HundredThousandPointsAreFittedAsWell) {
  StateGrid many{.inertial_numbers = {}, .softnesses = {0.005, 0.02}, .bond_numbers = {0}};
  for (int i = 0; i < 50000; ++i) {
    many.inertial_numbers.push_back(0.005 * std::pow(80.0, i / 49999.0));
  }
  const MaterialFit fit =
      fit_material(states(frictional, many, {.friction = 0.02, .volume_fraction = 0.003}));
  expect_within_errors(fit.friction["mu0"], frictional.friction.mu0);
  expect_within_errors(fit.friction["p_mu"], frictional.softness_friction->p_mu);
}

/// Cohesionless states, six runs of each, whose errors of mu and phi are correlated. Three values
/// of I: enough for mu0 and beta, phi0 and I_phi, and no term more.
std::vector<StatePoint> correlated_states(double correlation, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const auto exact =
      states(frictional,
             {.inertial_numbers = {0.02, 0.1, 0.2}, .softnesses = {0.01}, .bond_numbers = {0}});
  std::vector<StatePoint> points;
  for (int run = 0; run < 6; ++run) {
    for (StatePoint point : exact) {
      const double one = normal(random);
      const double other =
          correlation * one + std::sqrt(1.0 - correlation * correlation) * normal(random);
      point.friction = {point.friction.value + 0.004 * one, 0.004};
      point.volume_fraction = {point.volume_fraction.value + 0.001 * other, 0.001};
      point.correlation = correlation;
      points.push_back(point);
    }
  }
  return points;
}

TEST(MaterialFit, CoefficientsOfBothLawsAreCorrelatedAsTheirDataAre) {
  constexpr int replicates = 400;
  constexpr double correlation = 0.8;
  std::mt19937_64 random(7);
  double claimed = 0.0;
  std::array<double, 5> sums{};  // x, y, xx, yy, xy of mu0 and phi0
  for (int r = 0; r < replicates; ++r) {
    const MaterialFit fit = fit_material(correlated_states(correlation, random));
    const continuum::Covariance& c = *fit.table.covariance;
    const auto place = [&](const char* name) {
      return static_cast<std::size_t>(std::find(c.names.begin(), c.names.end(), name) -
                                      c.names.begin());
    };
    const std::size_t i = place("mu0"), j = place("phi0");
    claimed += c(i, j) / std::sqrt(c(i, i) * c(j, j)) / replicates;
    const double x = law_of(fit).friction.mu0;
    const double y = law_of(fit).volume_fraction.phi0;
    const std::array<double, 5> terms{x, y, x * x, y * y, x * y};
    for (std::size_t k = 0; k < 5; ++k) sums[k] += terms[k] / replicates;
  }
  const double found = (sums[4] - sums[0] * sums[1]) /
                       std::sqrt((sums[2] - sums[0] * sums[0]) * (sums[3] - sums[1] * sums[1]));
  // Same points, same weights: the correlation of the data. Scatter (1 - r^2)/sqrt(400), four.
  EXPECT_NEAR(found, claimed, 4.0 * (1.0 - correlation * correlation) / 20.0);
  EXPECT_GT(claimed, 0.7);
}

TEST(MaterialFit, RunHeldAtTheEdgeOfTheRangeIsInside) {
  StateGrid edge = cohesionless;
  edge.softnesses = {0.0025, 0.03};
  std::vector<StatePoint> points = states(frictional, edge);
  for (StatePoint& point : points) {
    if (point.softness.value < 0.03) continue;
    point.softness = {0.03001, 1e-5};  // an error above the bound
  }
  const MaterialFit fit = fit_material(points);
  EXPECT_FALSE(mentions(fit.volume_fraction.left_out, "is above 0.03"));
}

TEST(MaterialFit, PointThatIsNoStateIsNamedAndNotUsed) {
  std::vector<StatePoint> points = states(frictional, cohesionless);
  points[3].name = "drifting box";
  points[3].unfit = "not steady: drifting";
  points[3].friction.value *= 2.0;
  const MaterialFit fit = fit_material(points);
  EXPECT_EQ(fit.friction_weight[3], 0.0);
  EXPECT_TRUE(mentions(fit.friction.left_out, "drifting box is left out: not steady"));
  EXPECT_NEAR(law_of(fit).friction.mu0, frictional.friction.mu0, 1e-6);
}

}  // namespace
}  // namespace grainlaw::calibration
