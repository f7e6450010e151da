#pragma once

#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "dem/statistics.h"

namespace grainlaw::testing {

/// Correlated series of zero mean and unit variance, started in their stationary state; their
/// integrated correlation time is known exactly [samples].
class SeriesMaker {
 public:
  enum class Kind {
    autoregressive,  ///< x' = r x + noise, tau_int = (1 + r) / (1 - r) / 2
    two_times,       ///< half the variance white, half of it autoregressive and slower
    skewed,          ///< squares of an autoregressive series: a one-sided distribution
  };

  SeriesMaker(Kind kind, double correlation_time, unsigned seed)
      : kind_(kind), memory_(memory(kind, correlation_time)), random_(seed) {}

  std::vector<double> next(std::size_t length) {
    std::vector<double> series(length);
    double x = normal_(random_);
    const double noise = std::sqrt(1.0 - memory_ * memory_);
    for (double& value : series) {
      value = observed(x);
      x = memory_ * x + noise * normal_(random_);
    }
    return series;
  }

 private:
  static double memory(Kind kind, double time) {
    if (kind == Kind::two_times) time = 2.0 * time - 0.5;
    const double r = (2.0 * time - 1.0) / (2.0 * time + 1.0);
    return kind == Kind::skewed ? std::sqrt(r) : r;  // squares forget twice as fast
  }

  double observed(double x) {
    if (kind_ == Kind::two_times) return std::sqrt(0.5) * (x + normal_(random_));
    return kind_ == Kind::skewed ? (x * x - 1.0) / std::sqrt(2.0) : x;
  }

  Kind kind_;
  double memory_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// What the error bars of many series of one kind turn out to be worth.
struct ErrorBarRecord {
  double covered = 0.0;             ///< share of 95 % intervals that hold the truth
  double scatter_over_claim = 0.0;  ///< rms distance from the truth over rms standard error
  double effective_samples = 0.0;   ///< mean of the estimates
  double not_converged = 0.0;       ///< shares of series that are called so
  double few_samples = 0.0;
};

inline ErrorBarRecord error_bars(SeriesMaker maker, std::size_t length, int count) {
  ErrorBarRecord record;
  double scatter = 0.0, claimed = 0.0;
  for (int k = 0; k < count; ++k) {
    const dem::Estimate found = dem::block_average(maker.next(length)).estimate();
    const dem::Convergence word = dem::convergence(found.effective_samples);
    record.covered += std::abs(found.value) <= dem::half_width(found, 0.95);
    record.effective_samples += found.effective_samples;
    record.not_converged += word == dem::Convergence::not_converged;
    record.few_samples += word == dem::Convergence::few_samples;
    scatter += found.value * found.value;
    claimed += found.error * found.error;
  }
  record.scatter_over_claim = std::sqrt(scatter / claimed);
  for (double* share :
       {&record.covered, &record.effective_samples, &record.not_converged, &record.few_samples}) {
    *share /= count;
  }
  return record;
}

}  // namespace grainlaw::testing
