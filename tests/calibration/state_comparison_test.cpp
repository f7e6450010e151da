#include "calibration/state_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/continuum/example_laws.h"

namespace grainlaw::calibration {
namespace {

using continuum::RheologyTable;

constexpr double mu0 = 0.35, beta = 0.8, phi0 = 0.6, I_phi = 3.0;

/// mu = mu0 + beta I, phi = phi0 (1 - I / I_phi), data from I = 0.01 to 0.3.
RheologyTable linear_law() {
  RheologyTable table =
      continuum::table_of(continuum::MuPhi{.friction = {.mu0 = mu0, .beta = beta, .kappa = 0.0},
                                           .volume_fraction = {.phi0 = phi0, .I_phi = I_phi}});
  table.range.inertial_number = continuum::Range{0.01, 0.3};
  table.range.softness = continuum::Range{0.001, 0.01};
  return table;
}

StatePoint state_at(double I) {
  StatePoint point;
  point.name = "box";
  point.inertial_number = {I, 0.0};
  point.softness = {0.005, 0.0};
  point.friction = {mu0 + beta * I, 0.004};
  point.volume_fraction = {phi0 * (1.0 - I / I_phi), 0.001};
  return point;
}

TEST(StateComparison, ALawHasNoResidualAtItsOwnStates) {
  const StateComparison state = compare_state(state_at(0.1), linear_law());
  EXPECT_NEAR(state.friction.difference, 0.0, 1e-15);
  EXPECT_NEAR(state.volume_fraction.difference, 0.0, 1e-15);
  EXPECT_TRUE(state.out_of_domain.empty());
  EXPECT_EQ(state.friction.law_error, 0.0);  // the table states no errors
}

TEST(StateComparison, AnErrorOfICountsThroughTheSlopeOfTheLaw) {
  StatePoint point = state_at(0.1);
  point.inertial_number.error = 0.01;
  point.friction.value *= 1.02;
  const StateComparison state = compare_state(point, linear_law());
  const double mu = point.friction.value;
  EXPECT_NEAR(state.friction.difference, 1.0 / 1.02 - 1.0, 1e-12);
  EXPECT_NEAR(state.friction.statistics, std::hypot(0.004, beta * 0.01) / mu, 1e-9);
  EXPECT_NEAR(
      state.friction.in_standard_errors, (mu / 1.02 - mu) / std::hypot(0.004, beta * 0.01), 1e-6);
}

TEST(StateComparison, TheCovarianceOfTheTableIsTheErrorOfTheLaw) {
  RheologyTable table = linear_law();
  table.covariance = continuum::Covariance{{"mu0", "beta"}, {4e-6, -1e-6, -1e-6, 9e-6}};
  const double I = 0.1;
  const StateComparison state = compare_state(state_at(I), table);
  // The law is linear in both: exact but for rounding over a step of 1e-5.
  const double error = std::sqrt(4e-6 - 2.0 * I * 1e-6 + I * I * 9e-6);
  EXPECT_NEAR(state.friction.law.error, error, 1e-9);
  EXPECT_NEAR(state.friction.law_error, error / (mu0 + beta * I), 1e-9);
}

TEST(StateComparison, TheConditionNumberOfALinearLawIsMuOverMuMinusMu0) {
  const double I = 0.05;
  const StateComparison state = compare_state(state_at(I), linear_law());
  EXPECT_NEAR(state.condition_number, (mu0 + beta * I) / (beta * I), 1e-8);
}

TEST(StateComparison, StatesOutsideTheDataAreFlagged) {
  StatePoint point = state_at(0.5);
  point.softness = {0.02, 0.0};
  const StateComparison state = compare_state(point, linear_law());
  ASSERT_EQ(state.out_of_domain.size(), 2u);
  EXPECT_EQ(state.out_of_domain[0].quantity, "I");
  EXPECT_EQ(state.out_of_domain[1].quantity, "p*");
  point = state_at(0.1);
  point.softness = {1e-5, 0.0};  // softness drops out of every law there
  EXPECT_TRUE(compare_state(point, linear_law()).out_of_domain.empty());
}

TEST(StateComparison, BondNumberAndFrictionOfARowArePositiveInBothHalvesOfABox) {
  dem::ChuteConditions conditions;
  conditions.attraction = 3.0;
  dem::LocalRow row;
  row.normal_stress = {10.0, 0.1};
  row.friction = {-0.4, 0.01};
  row.inertial_number = {-0.1, 0.002};
  const StatePoint point = state_of(row, conditions, "row");
  EXPECT_EQ(point.friction.value, 0.4);
  EXPECT_EQ(point.inertial_number.value, 0.1);
  EXPECT_NEAR(point.bond_number.value, 0.3, 1e-15);
  EXPECT_NEAR(point.bond_number.error, 0.003, 1e-15);
}

}  // namespace
}  // namespace grainlaw::calibration
