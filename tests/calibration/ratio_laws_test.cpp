#include "calibration/ratio_laws.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;
using testing::mentions;

/// Brewster et al. 2008, eq. 11: J = 1.25e5, alpha = -1.3, with errors of 5 % of Xi = 1.
std::vector<RatioPoint> stiffness_series() {
  std::vector<RatioPoint> points;
  for (const double k : {2e3, 5e3, 1e4, 2e4, 5e4, 2e5, 2e9}) {
    points.push_back({.name = "k_n = " + std::to_string(static_cast<long>(k)),
                      .x = k,
                      .ratio = {1.25e5 * std::pow(k, -1.3), 0.05}});
  }
  return points;
}

TEST(RatioLaws, PowerLawOfTheStiffnessComesBack) {
  const RatioLaw law = fit_ratio_power_law(stiffness_series());
  EXPECT_NEAR(law.factor.value, 1.25e5, 1e-6 * 1.25e5);
  EXPECT_NEAR(law.rate.value, -1.3, 1e-10);
  EXPECT_LT(law.factor.interval.lower, 1.25e5);
  EXPECT_GT(law.factor.interval.upper, 1.25e5);
}

TEST(RatioLaws, StiffGrainsWhoseRatioIsNotDetectedAreNamedAndLeftOut) {
  const RatioLaw law = fit_ratio_power_law(stiffness_series());
  EXPECT_EQ(law.used, (std::vector<bool>{true, true, true, true, false, false, false}));
  EXPECT_TRUE(mentions(law.summary.left_out,
                       "k_n = 200000 is left out: Xi = 0.016 +- 0.050 is not detected"));
  const RatioLaw without_softest = fit_ratio_power_law(stiffness_series(), {.least_x = 3e3});
  EXPECT_TRUE(mentions(without_softest.summary.left_out, "outside 3e+03"));
}

TEST(RatioLaws, ExponentialOfTheLifetimeComesBack) {
  // Eq. 14: Xi = 0.03 exp(4.9 gd tau_l).
  std::vector<RatioPoint> points;
  for (const double x : {0.3, 0.5, 0.7, 0.9, 1.1}) {
    const double xi = 0.03 * std::exp(4.9 * x);
    points.push_back({.name = "run", .x = x, .ratio = {xi, 0.1 * xi}});
  }
  const RatioLaw law = fit_ratio_exponential(points);
  EXPECT_NEAR(law.factor.value, 0.03, 1e-9);
  EXPECT_NEAR(law.rate.value, 4.9, 1e-8);
}

TEST(RatioLaws, TwoPointsAreTooFew) {
  std::vector<RatioPoint> points = stiffness_series();
  points.resize(2);
  EXPECT_NE(failure([&] { fit_ratio_power_law(points); }).find("3 points"), std::string::npos);
}

}  // namespace
}  // namespace grainlaw::calibration
