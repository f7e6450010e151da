#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "dem/estimate.h"
#include "dem/statistics.h"

namespace grainlaw::testing {

/// How often a claimed standard error covers the truth over many seeds.
class Coverage {
 public:
  void add(const dem::Estimate& estimate, double truth) {
    const double z = (estimate.value - truth) / estimate.error;
    inside_ += std::abs(z) <= 1.0 ? 1.0 : 0.0;
    sum_ += z;
    scatter_ += (estimate.value - truth) * (estimate.value - truth);
    claimed_ += estimate.error * estimate.error;
    count_ += 1.0;
  }
  void add(const calibration::FittedCoefficient& coefficient, double truth) {
    add(dem::Estimate{coefficient.value, coefficient.error}, truth);
  }

  double inside() const { return inside_ / count_; }
  double mean() const { return sum_ / count_; }
  double scatter_over_claim() const { return std::sqrt(scatter_ / claimed_); }

  /// What `count` independent z-scores of Student's t with about 11 degrees (12 blocks) allow at
  /// three standard errors: 66 % inside, mean 0, scatter equal to the claim. The claims themselves
  /// vary by 1/sqrt(2 * 11), which adds to the noise of their mean square.
  void expect_honest() const {
    constexpr double degrees = 11.0;
    constexpr double expected_inside = 0.661;
    const double inside_error = std::sqrt(expected_inside * (1.0 - expected_inside) / count_);
    EXPECT_NEAR(inside(), expected_inside, 3.0 * inside_error);
    EXPECT_NEAR(mean(), 0.0, 3.0 * std::sqrt(degrees / (degrees - 2.0) / count_));
    const double ratio_error = std::sqrt((0.5 + 0.5 / degrees) / count_);
    EXPECT_NEAR(scatter_over_claim(), 1.0, 3.0 * ratio_error);
  }

  /// The same where claims are enlarged to the scatter of the points whenever that is larger: they
  /// cover at least as often, and the truth still lies on both sides.
  void expect_honest_or_cautious() const {
    constexpr double least_inside = 0.661;
    const double inside_error = std::sqrt(least_inside * (1.0 - least_inside) / count_);
    EXPECT_GT(inside(), least_inside - 3.0 * inside_error);
    EXPECT_NEAR(mean(), 0.0, 3.0 * std::sqrt(11.0 / 9.0 / count_));
  }

 private:
  double inside_ = 0.0, sum_ = 0.0, scatter_ = 0.0, claimed_ = 0.0, count_ = 0.0;
};

inline bool mentions(const std::vector<std::string>& sentences, const std::string& words) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
    return sentence.find(words) != std::string::npos;
  });
}

/// How often a 95 % interval holds the truth over many seeds.
class IntervalCoverage {
 public:
  void add(const calibration::Interval& interval, double truth) {
    inside_ += interval.lower <= truth && truth <= interval.upper ? 1.0 : 0.0;
    by_profile_ += interval.by_profile ? 1.0 : 0.0;
    count_ += 1.0;
  }
  double inside() const { return inside_ / count_; }
  double by_profile() const { return by_profile_ / count_; }

 private:
  double inside_ = 0.0, by_profile_ = 0.0, count_ = 0.0;
};

/// The message of the FitError that `action` throws; empty when it does not.
template <class Action>
std::string failure(Action action) {
  try {
    action();
  } catch (const calibration::FitError& error) {
    return error.what();
  }
  return "";
}

}  // namespace grainlaw::testing
