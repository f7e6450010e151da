#include "calibration/contact_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using testing::mentions;
using testing::SyntheticChute;

/// b that gives Xi = b/(a gd) under half of the mass.
SyntheticChute chute_of_ratio(double ratio) {
  SyntheticChute chute;
  chute.velocity_noise = 2e-3;
  chute.stress_noise = 1e-3;
  const double tau =
      0.5 * testing::conditions_of(chute).mass_per_area * std::sin(chute.inclination);
  chute.b = ratio * std::sqrt(tau * chute.a / (1.0 + ratio));
  return chute;
}

/// One contact definition whose numbers follow a power of the stiffness, long ones excepted.
dem::LifetimeStatistics lifetimes(double stiffness, double scaled_long) {
  dem::LifetimeDistribution distance;
  const double contact_time = M_PI / std::sqrt(2.0 * stiffness);
  distance.contacts = 1e5;
  distance.mean = {1.2 * contact_time, 0.01 * contact_time};
  distance.mode = {contact_time, 0.01 * contact_time};
  const double rate = 2.0 * std::pow(stiffness, 0.25);
  distance.collision_rate = {rate, 0.01 * rate};
  distance.long_lifetime = {dem::Estimate{0.5 * scaled_long, 0.01},
                            dem::Estimate{scaled_long, 0.01},
                            dem::Estimate{1.5 * scaled_long, 0.01}};
  distance.beyond = {1e3, 1e3, 1e3};
  return {.shear_rate = 0.3, .distances = {distance}};
}

/// Xi = 0.03 exp(4.9 gd tau_l), Brewster et al. 2008, eq. 14.
dem::LocalData run(double stiffness, double scaled_long) {
  SyntheticChute chute = chute_of_ratio(0.03 * std::exp(4.9 * scaled_long));
  chute.name = "kn" + std::to_string(static_cast<long>(stiffness));
  dem::LocalData data = testing::local_data(chute);
  data.conditions.stiffness = stiffness;
  data.lifetimes = lifetimes(stiffness, scaled_long);
  return data;
}

std::vector<dem::LocalData> stiffness_series() {
  return {run(2e3, 1.0), run(1e4, 0.8), run(2e4, 0.7), run(1e5, 0.5)};
}

ContactSeries series_of(const std::vector<dem::LocalData>& runs) {
  std::vector<SeriesRun> entries;
  for (const dem::LocalData& data : runs) entries.push_back({"Hooke", &data});
  return contact_series(entries, 0);
}

TEST(ContactSeries, FindsTheExponentialOfTheLongLifetime) {
  const ContactSeries series = series_of(stiffness_series());
  ASSERT_TRUE(series.lifetime_law);
  const FittedCoefficient& rate = series.lifetime_law->rate;
  EXPECT_LT(rate.interval.lower, 4.9);
  EXPECT_GT(rate.interval.upper, 4.9);
  EXPECT_LT(rate.error, 0.5);
}

TEST(ContactSeries, CollisionRateAndMeanLifetimeFollowTheStiffness) {
  const ContactSeries series = series_of(stiffness_series());
  ASSERT_EQ(series.stiffness.size(), 1u);
  ASSERT_TRUE(series.stiffness[0].collision_rate);
  EXPECT_NEAR(series.stiffness[0].collision_rate->rate.value, 0.25, 1e-6);
  ASSERT_TRUE(series.stiffness[0].mean_lifetime);
  EXPECT_NEAR(series.stiffness[0].mean_lifetime->rate.value, -0.5, 1e-6);
}

TEST(ContactSeries, RanksOfXiFollowTheLongLifetimeAndNotAShorterOneThatDoesNotOrderThem) {
  std::vector<dem::LocalData> runs = stiffness_series();
  runs[0].lifetimes->distances[0].mode.value = 1e-6;  // the softest: shortest mode
  const ContactSeries series = series_of(runs);
  EXPECT_EQ(series.correlations[0].with, "gd tau_l");
  EXPECT_DOUBLE_EQ(series.correlations[0].value, 1.0);
  EXPECT_LT(series.correlations[2].value, 0.5);
}

TEST(ContactSeries, RunsWithoutLifetimesHaveTheirXiAlone) {
  std::vector<dem::LocalData> runs = stiffness_series();
  runs[1].lifetimes.reset();
  runs[2].window = {.steady = false, .reason = "drifting"};
  const ContactSeries series = series_of(runs);
  ASSERT_EQ(series.points.size(), 3u);
  EXPECT_FALSE(series.points[1].has_lifetimes());
  EXPECT_GT(series.points[1].ratio[1].value, 0.0);
  EXPECT_TRUE(std::isnan(series.points[1].mean.value));
  EXPECT_TRUE(mentions(series.left_out, "kn20000: is not steady: drifting"));
  EXPECT_FALSE(series.lifetime_law);
  EXPECT_TRUE(mentions(series.left_out, "3 points"));
}

TEST(RankCorrelation, CountsTiesAsTheirMeanRank) {
  const std::vector<double> x{1.0, 2.0, 2.0, 4.0};
  EXPECT_DOUBLE_EQ(rank_correlation(x, x), 1.0);
  const std::vector<double> falling{4.0, 2.0, 2.0, 1.0};
  EXPECT_DOUBLE_EQ(rank_correlation(x, falling), -1.0);
  EXPECT_TRUE(std::isnan(rank_correlation({}, {})));
}

}  // namespace
}  // namespace grainlaw::calibration
