#include "calibration/budget_plan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace grainlaw::calibration {
namespace {

/// A straight mu(I) of rigid grains with a constant volume fraction.
continuum::RheologyTable straight_law() {
  continuum::RheologyTable table;
  continuum::MuPhi law;
  law.friction = {.mu0 = 0.36, .beta = 0.6, .kappa = 0.0};
  law.volume_fraction = {.phi0 = 0.58, .I_phi = INFINITY};
  table.law = law;
  table.covariance = continuum::Covariance{{"mu0", "beta", "phi0"},
                                           {1e-6, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-8}};
  return table;
}

continuum::ChuteCase chute_of(double tilt) {
  return {.inclination = tilt, .gravity = 1.0, .mass_per_area = 20.0, .grains = {}};
}

const std::vector<std::string> both{"mu0", "beta"};
const std::vector<std::string> curved{"mu0", "beta", "kappa"};

TEST(BudgetPlan, PlacesOnALineAreTakenFromTheEndsInwards) {
  const std::vector<std::vector<double>> places{{0.0}, {1.0}, {2.0}, {3.0}, {4.0}};
  EXPECT_EQ(spread_order(places), (std::vector<std::size_t>{0, 4, 2, 1, 3}));
}

TEST(BudgetPlan, TheUnitsOfACoordinateDoNotMatterToTheOrder) {
  std::vector<std::vector<double>> places;
  for (double x : {0.0, 1.0, 2.0}) {
    for (double y : {0.0, 1.0}) places.push_back({x, y});
  }
  std::vector<std::vector<double>> scaled = places;
  for (auto& place : scaled) place[1] *= 1e6;
  EXPECT_EQ(spread_order(places), spread_order(scaled));
  EXPECT_EQ(varied_coordinates(places), 2);
  EXPECT_EQ(varied_coordinates({{1.0, 5.0}, {2.0, 5.0}}), 1);
}

TEST(BudgetPlan, PlacesOfDifferentLengthAreRefused) {
  EXPECT_THROW(spread_order({{0.0}, {1.0, 2.0}}), std::invalid_argument);
}

TEST(BudgetPlan, FrictionThatHasAnErrorCanBeImprovedAndACurvatureThatWasLeftOut) {
  EXPECT_EQ(friction_coefficients(straight_law()), curved);
  continuum::RheologyTable exact = straight_law();
  exact.covariance.reset();
  EXPECT_TRUE(friction_coefficients(exact).empty());
}

TEST(BudgetPlan, APowerLawIsNotCurvedTwice) {
  continuum::RheologyTable power = straight_law();
  std::get<continuum::MuPhi>(power.law).friction.exponent = 0.8;
  EXPECT_EQ(friction_coefficients(power), both);
}

TEST(BudgetPlan, GradientOfAStraightLawIsOneAndI) {
  const auto g = friction_gradient(straight_law(), both, {.inertial_number = 0.2});
  // mu is linear in both: a forward difference errs by rounding over the step, 1e-16 / 1e-7.
  EXPECT_NEAR(g[0], 1.0, 1e-8);
  EXPECT_NEAR(g[1], 0.2, 1e-8);
}

TEST(BudgetPlan, SurfaceVelocityIsAsSensitiveAsTheInertialNumberOfTheTilt) {
  // mu = tan(theta) at all depths and u_s ~ I (Bagnold): d ln u_s / d mu0 = -1 / (mu - mu0) and
  // d ln u_s / d beta = -1 / beta.
  const double tilt = 0.40;
  const auto g = velocity_gradient(straight_law(), both, chute_of(tilt));
  ASSERT_EQ(g.size(), 2u);
  const double distance = std::tan(tilt) - 0.36;
  // Forward difference: relative error (step / distance) = 1e-5 x 0.36 / 0.063 = 6e-5.
  EXPECT_NEAR(g[0] * distance, -1.0, 1e-4);
  EXPECT_NEAR(g[1] * 0.6, -1.0, 1e-4);
}

TEST(BudgetPlan, ATargetThatRestsHasNoGradientAndNoVelocity) {
  EXPECT_TRUE(velocity_gradient(straight_law(), both, chute_of(0.2)).empty());
  EXPECT_TRUE(std::isnan(surface_velocity(straight_law(), chute_of(0.2)).value));
}

TEST(BudgetPlan, ErrorOfInertiaCountsByTheSlopeOfTheLaw) {
  const State state{.inertial_number = 0.1};
  EXPECT_NEAR(effective_friction_error(straight_law(), state, 0.003, 0.0), 0.003, 1e-12);
  // 3-4-5: slope 0.6 times 0.004 / 0.6.
  EXPECT_NEAR(effective_friction_error(straight_law(), state, 0.003, 0.004 / 0.6), 0.005, 1e-9);
}

TEST(BudgetPlan, InformationAddsUpOverRuns) {
  const std::vector<Observation> one{{{.inertial_number = 0.2}, 0.01}};
  const auto information = information_of(straight_law(), both, one);
  EXPECT_NEAR(information[0], 1e4, 1e-3);
  EXPECT_NEAR(information[1], 0.2e4, 1e-3);
  EXPECT_NEAR(information[3], 0.04e4, 1e-3);
  const std::vector<Observation> two{one[0], one[0]};
  EXPECT_NEAR(information_of(straight_law(), both, two)[3], 2.0 * information[3], 1e-9);
}

/// Three boxes of a straight law, equally noisy.
std::vector<Candidate> boxes() {
  std::vector<Candidate> candidates;
  for (double I : {0.02, 0.1, 0.3}) {
    candidates.push_back(
        {.state = {.inertial_number = I}, .run = 10.0, .warm_up = 1.0, .noise = 0.01});
  }
  return candidates;
}

std::size_t wanted(const std::vector<Candidate>& candidates, const std::vector<Observation>& told) {
  const std::vector<std::vector<double>> targets{{1.0, 0.1}};  // mu at I = 0.1
  const auto known = information_of(straight_law(), both, told);
  return most_wanted(straight_law(), both, candidates, targets, known, 10.0);
}

TEST(BudgetPlan, TheEndThatWasMeasuredWorseIsWantedMost) {
  const Observation low{{.inertial_number = 0.02}, 1e-5};
  const Observation high{{.inertial_number = 0.3}, 1e-2};
  // mu(0.02) is known: what is left unknown of mu(0.1) is the slope, best seen far away.
  EXPECT_EQ(wanted(boxes(), {low, high}), 2u);
}

TEST(BudgetPlan, TwoPointsDoNotTellALawBetweenThemThatMayBeCurved) {
  // The ends are known exactly. The chord of I^2 through them is 0.32 I - 0.006 = 0.026 at I = 0.1,
  // where I^2 = 0.01: kappa = 4 moves mu there by beta x 0.016 x 4.
  const Observation low{{.inertial_number = 0.02}, 1e-6};
  const Observation high{{.inertial_number = 0.3}, 1e-6};
  const std::vector<Observation> told{low, high};
  const auto known = information_of(straight_law(), curved, told);
  const auto g = friction_gradient(straight_law(), curved, {.inertial_number = 0.1});
  const std::vector<std::vector<double>> target{g};
  // The ends leave an error of 1e-6 each.
  EXPECT_NEAR(std::sqrt(mean_variance(target, known)), 0.6 * 0.016 * 4.0, 1e-5);
  EXPECT_EQ(most_wanted(straight_law(), curved, boxes(), target, known, 10.0), 1u);
}

TEST(BudgetPlan, ACandidateWhoseWarmUpFillsTheRunIsPassedOver) {
  const Observation low{{.inertial_number = 0.02}, 1e-5};
  const Observation high{{.inertial_number = 0.3}, 1e-2};
  std::vector<Candidate> candidates = boxes();
  candidates[2].warm_up = 10.0;
  EXPECT_EQ(wanted(candidates, {low, high}), 1u);
  for (Candidate& one : candidates) one.warm_up = 11.0;
  EXPECT_THROW(wanted(candidates, {low, high}), std::invalid_argument);
}

}  // namespace
}  // namespace grainlaw::calibration
