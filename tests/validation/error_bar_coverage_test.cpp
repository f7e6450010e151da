// How often 95 % intervals from block averages hold the truth: the tables of docs/error_bars.md.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/support/correlated_series.h"

namespace grainlaw::testing {
namespace {

using Kind = SeriesMaker::Kind;

ErrorBarRecord cell(Kind kind, double correlation_time, double effective_samples) {
  constexpr int series = 4000;
  const auto length =
      static_cast<std::size_t>(std::lround(2.0 * correlation_time * effective_samples));
  const auto seed = static_cast<unsigned>(1000.0 * correlation_time + effective_samples);
  const ErrorBarRecord record =
      error_bars(SeriesMaker(kind, correlation_time, seed), length, series);
  std::printf("| %g | %g | %.1f | %.2f | %.0f | %.0f | %.0f | %.0f |\n",
              correlation_time,
              effective_samples,
              100.0 * record.covered,
              record.scatter_over_claim,
              record.effective_samples,
              100.0 * record.not_converged,
              100.0 * record.few_samples,
              100.0 * (1.0 - record.not_converged - record.few_samples));
  return record;
}

TEST(ErrorBarCoverage, OfAutoregressiveSeriesIs93To97PercentFrom100SamplesOn) {
  for (const double correlation_time : {1.0, 2.0, 5.0, 10.0, 20.0, 50.0}) {
    for (const double effective_samples : {10.0, 20.0, 50.0, 100.0, 300.0, 1000.0}) {
      const double covered =
          cell(Kind::autoregressive, correlation_time, effective_samples).covered;
      if (effective_samples < 100.0) continue;
      EXPECT_GE(covered, 0.93) << correlation_time << ' ' << effective_samples;
      EXPECT_LE(covered, 0.97) << correlation_time << ' ' << effective_samples;
    }
  }
}

// What it was not made for: two correlation times, a skewed distribution, values that alternate.
TEST(ErrorBarCoverage, OfOtherSeriesIsNotMuchWorse) {
  struct Other {
    Kind kind;
    double correlation_time;
  };
  for (const auto [kind, correlation_time] : {Other{Kind::two_times, 5.0},
                                              Other{Kind::skewed, 5.0},
                                              Other{Kind::autoregressive, 0.5},
                                              Other{Kind::autoregressive, 0.25}}) {
    for (const double effective_samples : {10.0, 20.0, 50.0, 100.0, 300.0, 1000.0}) {
      const double covered = cell(kind, correlation_time, effective_samples).covered;
      if (effective_samples >= 300.0) {
        EXPECT_GE(covered, 0.93) << correlation_time << ' ' << effective_samples;
      }
    }
  }
}

}  // namespace
}  // namespace grainlaw::testing
