#include "dem/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dem/local_data.h"
#include "tests/support/correlated_series.h"

namespace grainlaw::dem {
namespace {

using testing::ErrorBarRecord;
using testing::SeriesMaker;
using Kind = SeriesMaker::Kind;

std::vector<double> autoregressive(double correlation_time, std::size_t length, unsigned seed) {
  return SeriesMaker(Kind::autoregressive, correlation_time, seed).next(length);
}

class BlockAverageOf : public ::testing::TestWithParam<double> {};

TEST_P(BlockAverageOf, AutoregressiveSeriesClaimsTheErrorItHas) {
  constexpr int count = 4000;
  constexpr double independent = 100.0;
  const auto length = static_cast<std::size_t>(2.0 * GetParam() * independent);
  const ErrorBarRecord record =
      testing::error_bars(SeriesMaker(Kind::autoregressive, GetParam(), 1), length, count);
  // 4000 intervals are right in 95 % +- 0.34 %; 3 of that, and 1 % for Student's t of a variance
  // that is not exactly a chi-square.
  EXPECT_NEAR(record.covered, 0.95, 3.0 * 0.0034 + 0.01);
  // The rms of 4000 means knows itself to 1/sqrt(8000) = 1.1 %; 3 of that. Left of the bias of
  // blocks: second order in tau / B, 1.5 %.
  EXPECT_NEAR(record.scatter_over_claim, 1.0, 3.0 * 0.011 + 0.015);
  // E[1/V] > 1/E[V] with 20 degrees: by 1 / (1 - 2/20) at most.
  EXPECT_NEAR(record.effective_samples, 1.05 * independent, 0.05 * independent);
}

INSTANTIATE_TEST_SUITE_P(CorrelationTimes, BlockAverageOf, ::testing::Values(1.0, 5.0, 20.0));

TEST(BlockAverage, KnowsSeriesThatAlternateBetterThanTheirNumberOfSamples) {
  // r = -1/3, tau_int = 0.25: the mean is known twice as well as from independent samples, of which
  // not more than all are counted.
  double claimed2 = 0.0;
  constexpr int count = 400;
  constexpr std::size_t length = 1000;
  SeriesMaker maker(Kind::autoregressive, 0.25, 1);
  for (int k = 0; k < count; ++k) {
    const BlockAverage average = block_average(maker.next(length));
    claimed2 += average.error * average.error / count;
    EXPECT_LE(average.effective_samples, static_cast<double>(length));
  }
  // Blocks of B = 9 leave 1 + |2 r / (1 - r^2)| / B of the variance, 8 % more; 92 degrees of each.
  EXPECT_NEAR(claimed2 * length, 0.5 * 1.083, 3.0 * 0.5 * std::sqrt(2.0 / 92.0 / count) + 0.02);
}

TEST(BlockAverage, TooFewSamplesHaveNoError) {
  EXPECT_TRUE(std::isnan(block_average(std::vector{1.0, 2.0, 3.0}).error));
  EXPECT_DOUBLE_EQ(block_average(std::vector{1.0, 2.0, 3.0}).mean, 2.0);
}

TEST(Convergence, IsSaidByTheNumberOfIndependentSamples) {
  EXPECT_EQ(name(convergence(19.9)), "not converged");
  EXPECT_EQ(name(convergence(20.0)), "short");
  EXPECT_EQ(name(convergence(99.9)), "short");
  EXPECT_EQ(name(convergence(100.0)), "converged");
  EXPECT_EQ(name(convergence(std::nan(""))), "not converged");
}

TEST(Convergence, OfASeriesFollowsFromItsCorrelation) {
  // 500 and 5 independent samples; known to an eighth, and to a factor of two, the word is sure.
  const auto word = [](double correlation_time, std::size_t length) {
    return convergence(
        block_average(autoregressive(correlation_time, length, 1)).effective_samples);
  };
  EXPECT_EQ(word(1.0, 1000), Convergence::converged);
  EXPECT_EQ(word(50.0, 500), Convergence::not_converged);
}

TEST(Convergence, OfAFieldIsThatOfItsWorstRow) {
  std::vector<LocalRow> rows(2);
  EXPECT_EQ(worst_convergence(rows, &LocalRow::velocity), Convergence::not_converged);
  rows[0].velocity.effective_samples = 300.0;
  rows[1].velocity.effective_samples = 30.0;
  EXPECT_EQ(worst_convergence(rows, &LocalRow::velocity), Convergence::few_samples);
}

TEST(HalfWidth, IsStudentsForTheBlocksAndNormalWhereTheyAreUnknown) {
  // 17.1 blocks of 2 tau / 0.171 fit in 100 independent samples: 3/2 16.1 (0.829 / 0.915)^2 = 19.8
  // degrees; t = 2.087 (Abramowitz and Stegun, table 26.10: 2.093 for 19, 2.086 for 20).
  EXPECT_NEAR(degrees_of_freedom(100.0), 19.8, 0.1);
  EXPECT_NEAR(half_width({1.0, 0.1, 100.0}, 0.95), 0.2087, 1e-4);
  EXPECT_NEAR(half_width({1.0, 0.1}, 0.95), 0.196, 3e-4);
  EXPECT_GE(degrees_of_freedom(1.0), 1.0);
}

TEST(BlockAverage, ConstantSeriesIsExact) {
  const BlockAverage average = block_average(std::vector<double>(50, 3.0));
  EXPECT_DOUBLE_EQ(average.mean, 3.0);
  EXPECT_DOUBLE_EQ(average.error, 0.0);
  EXPECT_DOUBLE_EQ(average.effective_samples, 50.0);
}

TEST(Mser, CutsARelaxingStartAndKeepsAStationaryOne) {
  auto series = autoregressive(0.93, 400, 2);
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
  // Between whole degrees: the density integrated by Simpson's rule.
  EXPECT_NEAR(student_quantile(0.975, 1.5), 6.017, 0.03 * 6.017);
  EXPECT_NEAR(student_quantile(0.975, 2.5), 3.575, 0.03 * 3.575);
}

TEST(LinearDrift, IsFoundWhereThereIsOneAndRarelyWhereThereIsNone) {
  int found = 0, imagined = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    auto series = autoregressive(1.5, 500, seed);
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
