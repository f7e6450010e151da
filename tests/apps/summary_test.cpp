#include "apps/summary.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace grainlaw {
namespace {

TEST(Summary, ValueAndErrorAreRoundedToTwoDigitsOfTheError) {
  EXPECT_EQ(value_with_error(0.371234, 0.0041), "0.3712 +- 0.0041");
  EXPECT_EQ(value_with_error(12.34567, 0.123), "12.35 +- 0.12");
  EXPECT_EQ(value_with_error(1234.5, 56.0), "1234 +- 56");
}

TEST(Summary, AbsentNumbersAreWordsForPeopleAndNullForPrograms) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Summary summary;
  summary.add_estimate("x", "x", nan, nan);
  EXPECT_EQ(summary.text(), "x  not measured\n");
  EXPECT_NE(summary.json().find("\"value\": null"), std::string::npos);
}

TEST(Summary, SaysHowFarAnErrorCanBeTrusted) {
  Summary summary;
  summary.add_estimate("phi", "phi", 0.58, 0.008, "", {0.018, "not converged"});
  EXPECT_EQ(summary.text(), "phi  0.5800 +- 0.0080 (not converged)\n");
  EXPECT_NE(summary.json().find("\"half_width_95\": 0.018"), std::string::npos);
  EXPECT_NE(summary.json().find("\"convergence\": \"not converged\""), std::string::npos);
}

TEST(Summary, LongTextStaysWithinEightyColumns) {
  Summary summary;
  std::string words;
  for (int k = 0; k < 60; ++k) words += "grains ";
  summary.add("text", "a label", words);
  std::istringstream lines(summary.text());
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

}  // namespace
}  // namespace grainlaw
