#include "calibration/model_choice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace grainlaw::calibration {
namespace {

TEST(ModelChoice, FDistributionAgreesWithItsClosedForms) {
  // Two numerator degrees: P(F > f) = (1 + 2 f / d)^(-d/2). One and one: 1 - 2/pi atan(sqrt f).
  for (const double f : {0.1, 1.0, 4.0, 40.0}) {
    EXPECT_NEAR(f_survival(f, 2, 7), std::pow(1.0 + 2.0 * f / 7.0, -3.5), 1e-13);
    EXPECT_NEAR(f_survival(f, 2, 1e5), std::pow(1.0 + 2e-5 * f, -5e4), 1e-9);
    EXPECT_NEAR(f_survival(f, 1, 1), 1.0 - 2.0 / M_PI * std::atan(std::sqrt(f)), 1e-13);
  }
  EXPECT_EQ(f_survival(0.0, 3, 5), 1.0);
}

TEST(ModelChoice, TermThatTakesItsShareOfTheScatterIsChanceOneTimeInThree) {
  // One useless term lowers chi^2 by one degree's worth on average; F = 1 with (1, infinity)
  // degrees is a normal deviate beyond one standard deviation, 31.7 %.
  const ModelScore small{.coefficients = 2, .chi_squared = 100001.0};
  const ModelScore large{.coefficients = 3, .chi_squared = 100000.0};
  EXPECT_NEAR(chance_of_gain(small, large, 100003), 0.3173, 1e-4);
  EXPECT_EQ(chance_of_gain(large, small, 100), 1.0);
}

TEST(ModelChoice, AkaikeAsksForMoreGainWhereDataAreFew) {
  // By hand, n = 10, two coefficients and the scale: 10 ln 0.5 + 6 + 24/6.
  EXPECT_NEAR(corrected_akaike(5.0, 10, 2), 10.0 * std::log(0.5) + 6.0 + 4.0, 1e-12);
  EXPECT_EQ(corrected_akaike(5.0, 4, 2), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace grainlaw::calibration
