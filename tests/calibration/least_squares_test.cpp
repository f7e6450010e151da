#include "calibration/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/differentiate.h"
#include "continuum/bagnold_profile.h"

namespace grainlaw::calibration {
namespace {

/// Straight line intercept + slope x through points with unit errors.
struct Line {
  std::vector<double> x;
  std::vector<double> y;

  template <class Scalar>
  void operator()(const std::array<Scalar, 2>& p, std::span<Scalar> r) const {
    for (std::size_t i = 0; i < x.size(); ++i) r[i] = p[0] + p[1] * x[i] - y[i];
  }
};

LeastSquaresProblem line_problem(const Line& line, double lower_slope = -1e300) {
  return {.unknowns = {{.name = "intercept", .start = 0.0},
                       {.name = "slope", .start = 0.0, .lower = lower_slope}},
          .residuals = static_cast<int>(line.x.size()),
          .evaluate = differentiate<2>(line)};
}

const Line example{{0.0, 1.0, 2.0, 3.0}, {1.0, 2.0, 2.0, 4.0}};

TEST(LeastSquares, StraightLineHasTheTextbookValuesAndErrors) {
  // Normal equations by hand: x mean 1.5, Sxx = 5, Sxy = 4.5, y mean 2.25.
  const auto problem = line_problem(example);
  const Minimum minimum = minimise(problem);
  EXPECT_TRUE(minimum.converged) << minimum.termination;
  // The sum of squares (0.7) is flat to rounding within sqrt(epsilon chi^2) standard errors.
  const double blur = std::sqrt(2.2e-16 * 0.7);
  EXPECT_NEAR(minimum.values[1], 0.9, blur * std::sqrt(0.2));
  EXPECT_NEAR(minimum.values[0], 0.9, blur * std::sqrt(0.7));
  const Matrix covariance = uncertainty(problem, minimum).covariance;
  EXPECT_NEAR(covariance(1, 1), 1.0 / 5.0, 1e-14);
  EXPECT_NEAR(covariance(0, 0), 1.0 / 4.0 + 1.5 * 1.5 / 5.0, 1e-14);
  EXPECT_NEAR(covariance(0, 1), -1.5 / 5.0, 1e-14);
}

TEST(LeastSquares, SameInputGivesTheSameBits) {
  const auto problem = line_problem(example);
  EXPECT_EQ(minimise(problem).values, minimise(problem).values);
}

TEST(LeastSquares, UnknownBeyondItsBoundIsHeldThereAndTheRestFollows) {
  const auto problem = line_problem(example, 1.0);
  const Minimum minimum = minimise(problem);
  EXPECT_TRUE(minimum.at_bound[1]);
  EXPECT_FALSE(minimum.at_bound[0]);
  EXPECT_EQ(minimum.values[1], 1.0);
  EXPECT_NEAR(minimum.values[0], 2.25 - 1.5, std::sqrt(2.2e-16 * 0.75 * 0.7));  // as above
  // Its error is that of the free unknown: the data know it no better for the bound.
  EXPECT_NEAR(uncertainty(problem, minimum).covariance(1, 1), 1.0 / 5.0, 1e-14);
}

TEST(LeastSquares, CombinationWithoutEffectIsNamed) {
  const auto problem = line_problem(Line{{2.0, 2.0, 2.0}, {1.0, 2.0, 3.0}});
  const Uncertainty result = uncertainty(problem, minimise(problem));
  ASSERT_EQ(result.null_space.size(), 1u);
  EXPECT_NE(result.null_space[0].find("intercept"), std::string::npos);
  EXPECT_NE(result.null_space[0].find("slope"), std::string::npos);
  EXPECT_FALSE(result.identifiable[0]);
  EXPECT_FALSE(result.identifiable[1]);
}

TEST(LeastSquares, FewerDataThanUnknownsIsNamedNotFatal) {
  const auto problem = line_problem(Line{{2.0}, {1.0}});
  EXPECT_EQ(uncertainty(problem, minimise(problem)).null_space.size(), 1u);
}

TEST(LeastSquares, ModelWithoutAnyValueDoesNotConvergeNorAbort) {
  const auto problem = line_problem(Line{{1.0, 2.0}, {std::nan(""), 1.0}});
  const Minimum minimum = minimise(problem);
  EXPECT_FALSE(minimum.converged);
  EXPECT_THROW(require_converged(minimum, "a line"), FitError);
}

TEST(LeastSquares, FullyCorrelatedResidualsAreWorthOneDatum) {
  // The mean of four data that always move together is known no better than one of them; taken as
  // independent it would claim half of that error.
  LeastSquaresProblem mean{.unknowns = {{.name = "mean", .start = 0.0}},
                           .residuals = 4,
                           .evaluate = [](auto x, auto r, auto jacobian) {
                             for (double& v : r) v = x[0] - 1.0;
                             for (double& v : jacobian) v = 1.0;
                           }};
  const Minimum minimum = minimise(mean);
  Matrix noise(1, 4);
  noise.values.assign(4, 1.0);
  EXPECT_NEAR(uncertainty(mean, minimum, noise).covariance(0, 0), 1.0, 1e-14);
  EXPECT_NEAR(uncertainty(mean, minimum).covariance(0, 0), 0.25, 1e-14);
}

struct Velocity {
  template <class Scalar>
  void operator()(const std::array<Scalar, 3>& x, std::span<Scalar> r) const {
    r[0] = continuum::bagnold_velocity(x[0], x[1], Scalar(0.0), 0.43, x[2], 12.0);
  }
};

TEST(LeastSquares, DerivativesOfTheVelocityLawAgreeWithDifferences) {
  const auto law = differentiate<3>(Velocity{});
  const std::vector<double> x{26.0, 3.0, 39.0};
  double value = 0.0;
  std::vector<double> slopes(3);
  law(x, {&value, 1}, slopes);
  for (std::size_t j = 0; j < 3; ++j) {
    const double step = 1e-5 * x[j];  // rounding 1e-16/1e-5, truncation (1e-5)^2: both below 1e-9
    std::vector<double> up = x, down = x;
    up[j] += step;
    down[j] -= step;
    double high = 0.0, low = 0.0;
    law(up, {&high, 1}, {});
    law(down, {&low, 1}, {});
    EXPECT_NEAR(slopes[j] * x[j], (high - low) / (2.0 * step) * x[j], 1e-9 * value);
  }
}

}  // namespace
}  // namespace grainlaw::calibration
