#include "dem/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace grainlaw::dem {
namespace {

/// Autoregressive series x' = r x + noise, started in its stationary state: unit variance,
/// tau_int = (1 + r) / (1 - r) / 2.
std::vector<double> autoregressive(double r, std::size_t length, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> series{normal(random)};
  while (series.size() < length) {
    series.push_back(r * series.back() + std::sqrt(1.0 - r * r) * normal(random));
  }
  return series;
}

class BlockAverageOf : public testing::TestWithParam<double> {};

TEST_P(BlockAverageOf, AutoregressiveSeriesClaimsTheErrorItHas) {
  constexpr int series = 400;
  constexpr std::size_t length = 1000;
  double claimed2 = 0.0, true2 = 0.0, tau = 0.0;
  for (unsigned seed = 0; seed < series; ++seed) {
    const BlockAverage average = block_average(autoregressive(GetParam(), length, seed));
    claimed2 += average.error * average.error / series;
    true2 += average.mean * average.mean / series;
    tau += average.correlation_time / series;
  }
  const double exact_tau = 0.5 * (1.0 + GetParam()) / (1.0 - GetParam());
  // The scatter of 400 means knows its own error to 1/sqrt(800) = 3.5 %; 3 of that. Left of the
  // bias of blocks: second order in tau / B, 1.5 % here.
  EXPECT_NEAR(std::sqrt(claimed2 / true2), 1.0, 3.0 * 0.035 + 0.015);
  EXPECT_NEAR(tau, exact_tau, 0.2 * exact_tau);
}

INSTANTIATE_TEST_SUITE_P(Correlations, BlockAverageOf, testing::Values(0.0, 0.5, 0.9));

TEST(BlockAverage, TooFewSamplesHaveNoError) {
  EXPECT_TRUE(std::isnan(block_average(std::vector{1.0, 2.0, 3.0}).error));
  EXPECT_DOUBLE_EQ(block_average(std::vector{1.0, 2.0, 3.0}).mean, 2.0);
}

TEST(BlockAverage, SaysWhenTheSeriesIsTooShortForItsCorrelation) {
  EXPECT_TRUE(block_average(autoregressive(0.5, 1000, 1)).converged);
  EXPECT_FALSE(block_average(autoregressive(0.98, 100, 1)).converged);
}

TEST(BlockAverage, ConstantSeriesIsExact) {
  const BlockAverage average = block_average(std::vector<double>(50, 3.0));
  EXPECT_DOUBLE_EQ(average.mean, 3.0);
  EXPECT_DOUBLE_EQ(average.error, 0.0);
  EXPECT_DOUBLE_EQ(average.effective_samples, 50.0);
}

TEST(Mser, CutsARelaxingStartAndKeepsAStationaryOne) {
  auto series = autoregressive(0.3, 400, 2);
  EXPECT_LT(mser_truncation(series), 100u);
  for (std::size_t k = 0; k < series.size(); ++k)
    series[k] -= 50.0 * std::exp(-0.05 * static_cast<double>(k));
  // The start is below the noise after ln(50) / 0.05 = 78 samples.
  EXPECT_GT(mser_truncation(series), 40u);
  EXPECT_LT(mser_truncation(series), 160u);
}

TEST(StudentQuantile, MatchesTheTables) {
  // Abramowitz and Stegun, table 26.10.
  EXPECT_NEAR(student_quantile(0.975, 1), 12.706, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 2), 4.303, 5e-4);
  EXPECT_NEAR(student_quantile(0.975, 5), 2.571, 5e-4);
  EXPECT_NEAR(student_quantile(0.995, 10), 3.169, 5e-4);
  EXPECT_NEAR(student_quantile(0.995, 1e6), 2.58, 5e-3);
}

TEST(LinearDrift, IsFoundWhereThereIsOneAndRarelyWhereThereIsNone) {
  int found = 0, imagined = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    auto series = autoregressive(0.5, 500, seed);
    imagined += linear_drift(series).significant(0.99);
    // Error of the drift over the window: sqrt(12) sqrt(2 tau / N) = 0.27; ten times that.
    for (std::size_t k = 0; k < series.size(); ++k)
      series[k] += 2.7 * static_cast<double>(k) / 500.0;
    found += linear_drift(series).significant(0.99);
  }
  EXPECT_EQ(found, 200);
  EXPECT_LE(imagined, 12);  // expected 2 and somewhat more: errors from few blocks are short
}

}  // namespace
}  // namespace grainlaw::dem
