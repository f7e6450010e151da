#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace grainlaw {

/// One line of docs/verification.md.
struct Verified {
  std::string id;    ///< V1 to V16
  std::string what;  ///< quantity and case
  double expected = 0.0;
  double measured = 0.0;
  double tolerance = 0.0;  ///< largest |measured - expected|
};

/// All of this program, in the order of the tests.
inline std::vector<Verified>& verified() {
  static std::vector<Verified> all;
  return all;
}

/// Checks and remembers a result.
inline void verify(
    std::string id, std::string what, double expected, double measured, double tolerance) {
  EXPECT_NEAR(measured, expected, tolerance) << id << ' ' << what;
  verified().push_back({std::move(id), std::move(what), expected, measured, tolerance});
}

/// The same for something given to a number of digits.
inline void verify_relative(
    std::string id, std::string what, double expected, double measured, double tolerance) {
  verify(std::move(id), std::move(what), expected, measured, tolerance * std::abs(expected));
}

/// Collects the largest of many differences.
class Largest {
 public:
  void add(double difference) { value_ = std::max(value_, std::abs(difference)); }
  double value() const { return value_; }

 private:
  double value_ = 0.0;
};

}  // namespace grainlaw
