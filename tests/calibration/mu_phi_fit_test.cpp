#include "calibration/mu_phi_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using testing::Coverage;
using testing::failure;
using testing::local_data;
using testing::mentions;
using testing::SyntheticChute;

constexpr double degree = std::numbers::pi / 180.0;

/// A material of which the chutes are made.
struct Material {
  double mu0 = 0.353;
  double beta = 0.50;
  double kappa = 0.0;
  double phi0 = 0.60;
  double I_phi = 5.4;
};

double inertial_number(const Material& m, double inclination) {
  return continuum::inertial_number_of(m.mu0, m.beta, m.kappa, std::tan(inclination));
}

SyntheticChute chute(const Material& m, double tilt, double noise = 0.0, std::uint64_t seed = 1) {
  const double inclination = tilt * degree;
  const double I = inertial_number(m, inclination);
  // The noise of a chute grows with its speed, as that of real flow does.
  return {.name = "tilt " + std::to_string(static_cast<int>(tilt)),
          .inclination = inclination,
          .a = testing::bagnold_coefficient(I, inclination),
          .volume_fraction = continuum::inertial_volume_fraction(m.phi0, m.I_phi, I),
          .velocity_noise = noise * I,
          .stress_noise = noise / 10.0,
          .seed = seed};
}

std::vector<dem::LocalData> campaign(const Material& m,
                                     const std::vector<double>& tilts,
                                     double noise = 0.0,
                                     std::uint64_t seed = 1) {
  std::vector<dem::LocalData> runs;
  for (const double tilt : tilts) {
    runs.push_back(local_data(chute(m, tilt, noise, 1000 * seed + runs.size())));
  }
  return runs;
}

const std::vector<double> three_tilts{21, 23, 25};
const std::vector<double> five_tilts{20, 21.5, 23, 24.5, 26};
const std::vector<double> ten_tilts{20, 20.7, 21.4, 22, 22.7, 23.4, 24, 24.7, 25.4, 26};

const continuum::MuPhi& law_of(const MuPhiFit& fit) {
  return std::get<continuum::MuPhi>(fit.table.law);
}

TEST(FlowPoint, BaseThatGrainsSlipOnBeginsAtItsTop) {
  FlowPoint point;
  point.no_slip_height.value = -0.4;
  point.mass_below.value = -0.2;
  EXPECT_EQ(effective_base(point).no_slip_height, 0.0);
  EXPECT_EQ(effective_base(point).mass_below, 0.0);
}

TEST(FlowPoint, ExactProfileGivesItsInertialNumberAndBase) {
  const Material material;
  const FlowPoint point = flow_point(local_data(chute(material, 23)));
  const double I = inertial_number(material, 23 * degree);
  EXPECT_NEAR(point.inertial_number.value, I, 1e-12);
  EXPECT_NEAR(point.friction.value, std::tan(23 * degree), 1e-12);
  const double phi = 0.60 * (1.0 - I / 5.4);
  EXPECT_NEAR(point.volume_fraction.value, phi, 1e-12);
  EXPECT_NEAR(point.no_slip_height.value, 1.1, 1e-10);
  EXPECT_NEAR(point.mass_below.value, testing::pocket_fraction + 1.1 * phi, 1e-10);
}

TEST(FlowPoint, JackknifeErrorsAreHonest) {
  const Material material;
  Coverage inertial, base, friction;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const FlowPoint point = flow_point(local_data(chute(material, 23, 0.5, seed)));
    inertial.add(point.inertial_number, inertial_number(material, 23 * degree));
    base.add(point.no_slip_height, 1.1);
    friction.add(point.friction, std::tan(23 * degree));
  }
  for (const Coverage* coverage : {&inertial, &base, &friction}) coverage->expect_honest();
}

TEST(FlowPoint, StressOutOfBalanceIsSaidAndMeasuredValueUsed) {
  dem::LocalData data = local_data(chute({}, 23, 0.2));
  EXPECT_EQ(friction_for_fit(flow_point(data)).value, std::tan(23 * degree));
  EXPECT_EQ(friction_for_fit(flow_point(data)).error, 0.0);
  for (dem::LocalRow& row : data.rows) row.shear_stress.value *= 1.1;
  const FlowPoint point = flow_point(data);
  EXPECT_TRUE(mentions(point.notes, "differs from tan(theta)"));
  EXPECT_EQ(friction_for_fit(point).value, point.friction.value);
}

TEST(FlowPoint, RunThatIsNotSteadyIsRefused) {
  dem::LocalData data = local_data(chute({}, 23));
  data.window = {.steady = false, .reason = "arrested"};
  EXPECT_NE(failure([&] { flow_point(data); }).find("arrested"), std::string::npos);
}

TEST(MuPhiFit, LinearLawIsRecoveredFromThreeFiveAndTenTilts) {
  const Material material;
  for (const auto& tilts : {three_tilts, five_tilts, ten_tilts}) {
    const MuPhiFit fit = fit_mu_phi(campaign(material, tilts));
    EXPECT_NEAR(law_of(fit).friction.mu0, material.mu0, 1e-8);
    EXPECT_NEAR(law_of(fit).friction.beta, material.beta, 1e-8);
    EXPECT_NEAR(law_of(fit).volume_fraction.phi0, material.phi0, 1e-8);
    EXPECT_NEAR(law_of(fit).volume_fraction.I_phi, material.I_phi, 1e-8 * material.I_phi);
    EXPECT_NEAR(fit.table.base->no_slip_height, 1.1, 1e-8);
    EXPECT_EQ(law_of(fit).friction.kappa, 0.0);
    EXPECT_TRUE(mentions(fit.friction.not_identifiable, "kappa is dropped"));
    EXPECT_NO_THROW(continuum::validate(fit.table));
  }
}

TEST(MuPhiFit, CurvedLawIsRecoveredFromFiveAndTenTilts) {
  const Material material{.kappa = 1.39};
  for (const auto& tilts : {five_tilts, ten_tilts}) {
    const MuPhiFit fit = fit_mu_phi(campaign(material, tilts));
    EXPECT_NEAR(law_of(fit).friction.mu0, material.mu0, 1e-8);
    EXPECT_NEAR(law_of(fit).friction.beta, material.beta, 1e-8);
    EXPECT_NEAR(law_of(fit).friction.kappa, material.kappa, 1e-7);
    EXPECT_TRUE(fit.friction.not_identifiable.empty());
    EXPECT_EQ(fit.table.covariance->names[2], "kappa");
  }
}

TEST(MuPhiFit, CurvatureIsNotReadOutOfThreeTilts) {
  const MuPhiFit fit = fit_mu_phi(campaign({.kappa = 1.39}, three_tilts));
  EXPECT_EQ(law_of(fit).friction.kappa, 0.0);
  EXPECT_TRUE(mentions(fit.friction.not_identifiable, "three tilts or fewer"));
}

TEST(MuPhiFit, CurvatureHiddenInTheNoiseIsDroppedWithABoundOnTheLargestFriction) {
  const MuPhiFit fit = fit_mu_phi(campaign({.kappa = 0.1}, five_tilts, 5.0));
  EXPECT_EQ(law_of(fit).friction.kappa, 0.0);
  EXPECT_TRUE(mentions(fit.friction.not_identifiable, "standard errors from the linear law"));
  EXPECT_TRUE(mentions(fit.friction.not_identifiable, "one-sided"));
}

TEST(MuPhiFit, ErrorsOfTheLinearLawNeverPromiseTooMuch) {
  const Material material;
  Coverage mu0, beta, height;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const MuPhiFit fit = fit_mu_phi(campaign(material, five_tilts, 5.0, seed));
    if (fit.table.covariance->names[2] == "kappa") continue;  // 5 % by the two-sided rule
    const continuum::Covariance& covariance = *fit.table.covariance;
    mu0.add(fit.friction["mu0"], material.mu0);
    beta.add(fit.friction["beta"], material.beta);
    height.add({fit.table.base->no_slip_height, std::sqrt(covariance(4, 4))}, 1.1);
  }
  for (const Coverage* coverage : {&mu0, &beta, &height}) coverage->expect_honest_or_cautious();
}

TEST(MuPhiFit, TwoTiltsGiveTheExactLineAndSaySo) {
  const MuPhiFit fit = fit_mu_phi(campaign({}, {21, 25}, 0.2));
  EXPECT_TRUE(mentions(fit.friction.notes, "not tested"));
  // Through both points: I at each tilt is what the run measured.
  for (const FlowPoint& point : fit.points) {
    const continuum::InertialFriction& law = law_of(fit).friction;
    const double mu =
        continuum::inertial_friction(law.mu0, law.beta, law.kappa, point.inertial_number.value);
    EXPECT_NEAR(mu, std::tan(point.inclination), 1e-10);
  }
  // By hand: beta = d mu / d I, so its relative error is that of the difference of I.
  const dem::Estimate& low = fit.points[0].inertial_number;
  const dem::Estimate& high = fit.points[1].inertial_number;
  EXPECT_NEAR(fit.friction["beta"].error / fit.friction["beta"].value,
              std::hypot(low.error, high.error) / (high.value - low.value),
              1e-8);
}

TEST(MuPhiFit, TwoRunsAtOneTiltAreOnePointOfTheLaw) {
  auto runs = campaign({}, {23, 23}, 0.2);
  EXPECT_NE(failure([&] { fit_mu_phi(runs); }).find("one tilt"), std::string::npos);
  runs.push_back(local_data(chute({}, 25, 0.2)));
  const MuPhiFit fit = fit_mu_phi(runs);
  EXPECT_EQ(fit.friction.data, 3);
  EXPECT_TRUE(mentions(fit.friction.not_identifiable, "three tilts or fewer"));
}

TEST(MuPhiFit, OneRunIsRefused) {
  EXPECT_NE(failure([] { fit_mu_phi(campaign({}, {23})); }).find("only one run"),
            std::string::npos);
  EXPECT_NE(failure([] { fit_mu_phi({}); }), "");
}

TEST(MuPhiFit, FrictionThatFallsWithTheInertialNumberIsRefused) {
  auto runs = campaign({}, {21, 25});
  std::swap(runs[0].conditions.inclination, runs[1].conditions.inclination);
  for (dem::LocalData& run : runs) {
    for (dem::LocalRow& row : run.rows) {
      row.shear_stress.value = row.normal_stress.value * std::tan(run.conditions.inclination);
    }
  }
  EXPECT_NE(failure([&] { fit_mu_phi(runs); }).find("does not rise"), std::string::npos);
}

TEST(MuPhiFit, RunsOfDifferentGrainsOrBasesAreNotMixed) {
  auto runs = campaign({}, {21, 25});
  runs[1].conditions.contact_friction = 0.1;
  EXPECT_NE(failure([&] { fit_mu_phi(runs); }).find("contact friction"), std::string::npos);
  runs = campaign({}, {21, 25});
  runs[1].conditions.base = "another";
  EXPECT_NE(failure([&] { fit_mu_phi(runs); }).find("different bases"), std::string::npos);
}

TEST(MuPhiFit, ConstantVolumeFractionHasNoInertialLimit) {
  const MuPhiFit fit =
      fit_mu_phi(campaign({.I_phi = std::numeric_limits<double>::infinity()}, five_tilts));
  EXPECT_EQ(law_of(fit).volume_fraction.I_phi, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(law_of(fit).volume_fraction.phi0, 0.60, 1e-8);
  EXPECT_TRUE(mentions(fit.volume_fraction.not_identifiable, "I_phi is dropped"));
  EXPECT_NO_THROW(continuum::validate(fit.table));
}

TEST(MuPhiFit, PointsThatScatterMoreThanTheirErrorsEnlargeThem) {
  // One run 5 % too fast: the others cannot know it, the law must not be sure of itself.
  auto runs = campaign({}, five_tilts, 0.05);
  const double sure = fit_mu_phi(runs).friction["mu0"].error;
  for (dem::LocalRow& row : runs[2].rows) row.velocity.value *= 1.05;
  const MuPhiFit fit = fit_mu_phi(runs);
  EXPECT_GT(fit.friction["mu0"].error, 2.0 * sure);
  EXPECT_TRUE(mentions(fit.friction.notes, "scatter about the law"));
}

TEST(MuPhiFit, TableKeepsTheParametersOfItsPartsApart) {
  const MuPhiFit fit = fit_mu_phi(campaign({}, five_tilts, 0.2));
  const continuum::Covariance& covariance = *fit.table.covariance;
  EXPECT_EQ(
      covariance.names,
      (std::vector<std::string>{"mu0", "beta", "phi0", "I_phi", "no_slip_height", "mass_below"}));
  EXPECT_LT(covariance(0, 1), 0.0);  // a steeper line starts lower
  EXPECT_EQ(covariance(1, 2), 0.0);
  EXPECT_EQ(covariance(3, 4), 0.0);
  EXPECT_GT(covariance(4, 5), 0.0);  // more mass below a higher no-slip height
  EXPECT_DOUBLE_EQ(fit.table.range.inertial_number->lower,
                   fit.points.front().inertial_number.value);
  EXPECT_DOUBLE_EQ(fit.table.range.inertial_number->upper, fit.points.back().inertial_number.value);
  EXPECT_NO_THROW(continuum::validate(fit.table));
}

}  // namespace
}  // namespace grainlaw::calibration
