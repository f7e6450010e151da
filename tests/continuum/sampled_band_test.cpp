#include "continuum/sampled_band.h"

#include <gtest/gtest.h>

#include "tests/continuum/example_laws.h"

namespace grainlaw::continuum {
namespace {

/// Bagnold flow of the incompressible linear law: u ~ (tan(theta) - mu0) / beta at every height.
RheologyTable linear_law(const Covariance& covariance) {
  MuPhi law = incompressible_spheres();
  law.friction.kappa = 0.0;
  RheologyTable table = table_of(law);
  table.covariance = covariance;
  return table;
}

SteadyChute with_band(const RheologyTable& table, const ChuteCase& of) {
  SteadyChute steady = steady_chute(table, of, {.rows = 21});
  add_error_band(steady, table, of);
  return steady;
}

TEST(SampledBand, OfACoefficientThatActsLinearlyIsTheLinearBand) {
  const ChuteCase of = chute(24, 29);
  const RheologyTable table = linear_law({{"mu0"}, {1e-6}});  // 1e-3 of a difference of 0.092
  const SteadyChute steady = with_band(table, of);
  const int n = 4000;
  const auto band = sample_error_band(steady, table, of, {.samples = n});
  ASSERT_TRUE(band);
  EXPECT_TRUE(band->agrees) << band->text;
  EXPECT_EQ(band->without_flow, 0);
  const double u = steady.profile.surface_velocity;
  const double deviation = u * 1e-3 / (std::tan(24 * degree) - 0.3530);
  EXPECT_NEAR(band->rows.back().deviation, deviation, 4.0 / std::sqrt(2.0 * n) * deviation);
  // a quantile of n draws: sqrt(p (1 - p) / n) / density(1.96), 0.042 standard deviations here
  EXPECT_NEAR(band->rows.back().lower, u - 1.96 * deviation, 0.17 * deviation);
  EXPECT_NEAR(band->rows.back().upper, u + 1.96 * deviation, 0.17 * deviation);
}

TEST(SampledBand, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const ChuteCase of = chute(24, 29);
  const RheologyTable table = linear_law({{"mu0", "beta"}, {1e-6, 0.0, 0.0, 1e-6}});
  const SteadyChute steady = with_band(table, of);
  const double one = sample_error_band(steady, table, of)->rows.back().deviation;
  EXPECT_EQ(one, sample_error_band(steady, table, of)->rows.back().deviation);
  EXPECT_NE(one, sample_error_band(steady, table, of, {.seed = 2})->rows.back().deviation);
}

TEST(SampledBand, KeepsCoefficientsTogetherThatVaryAsOne) {
  // (tan(theta) - mu0) / beta stays the same where both move in proportion: a singular covariance
  const ChuteCase of = chute(24, 29);
  const double excess = std::tan(24 * degree) - 0.3530;
  const RheologyTable law = linear_law({});
  const double beta = coefficient(law, "beta");
  const double error = 0.01;  // relative, of both
  const double of_mu0 = error * excess;
  const double of_beta = -error * beta;
  const RheologyTable table = linear_law(
      {{"mu0", "beta"}, {of_mu0 * of_mu0, of_mu0 * of_beta, of_mu0 * of_beta, of_beta * of_beta}});
  const auto band = sample_error_band(with_band(table, of), table, of);
  ASSERT_TRUE(band);
  const double u = steady_chute(table, of).profile.surface_velocity;
  EXPECT_LT(band->rows.back().deviation, 1e-7 * u);
}

TEST(SampledBand, SaysThatTheFlowMayNotExistWhereTheLinearBandCannotKnow) {
  // 20 degrees is 0.011 above the yield friction, known to 0.01: 14 % of the draws rest
  const ChuteCase of = chute(20, 29);
  const RheologyTable table = linear_law({{"mu0"}, {1e-4}});
  const int n = 2000;
  const auto band = sample_error_band(with_band(table, of), table, of, {.samples = n});
  ASSERT_TRUE(band);
  EXPECT_FALSE(band->agrees);
  const double sigmas = (std::tan(20 * degree) - 0.3530) / 0.01;
  const double rest = 0.5 * std::erfc(sigmas / std::sqrt(2.0));
  EXPECT_NEAR(band->without_flow, n * rest, 4.0 * std::sqrt(n * rest * (1.0 - rest)));
  EXPECT_NE(band->text.find("have no steady flow"), std::string::npos) << band->text;
}

TEST(SampledBand, SaysThatTheVelocityIsNotLinearInItsCoefficients) {
  // u ~ 1 / beta with beta known to 30 %: the draws scatter further up than down
  const ChuteCase of = chute(24, 29);
  const double beta = coefficient(linear_law({}), "beta");
  const RheologyTable table = linear_law({{"beta"}, {0.09 * beta * beta}});
  const SteadyChute steady = with_band(table, of);
  const auto band = sample_error_band(steady, table, of);
  ASSERT_TRUE(band);
  EXPECT_FALSE(band->agrees);
  const double u = steady.profile.surface_velocity;
  EXPECT_GT(band->rows.back().upper - u, 1.5 * (u - band->rows.back().lower));
  EXPECT_NE(band->text.find("not linear"), std::string::npos) << band->text;
}

TEST(SampledBand, IsAbsentWithoutACovariance) {
  const RheologyTable table = table_of(frictional_spheres());
  EXPECT_FALSE(sample_error_band(steady_chute(table, chute(24, 29)), table, chute(24, 29)));
}

}  // namespace
}  // namespace grainlaw::continuum
