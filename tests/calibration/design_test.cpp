#include "calibration/design.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace grainlaw::calibration {
namespace {

using List = std::vector<std::vector<double>>;

const std::vector<double> nothing_known{0.0, 0.0, 0.0, 0.0};

/// A straight line y = c0 + c1 x, all data equally good.
List line(const std::vector<double>& x) {
  List gradients;
  for (const double value : x) gradients.push_back({1.0, value});
  return gradients;
}

TEST(VOptimalDesign, OfALineWithAnEndAsTargetPutsAllTimeThere) {
  // The variance of the datum itself is 1 per second; no other choice can do better.
  const Design design = v_optimal(line({0.0, 0.5, 1.0}), line({1.0}), nothing_known, 4.0);
  EXPECT_GT(design.share[2], 0.98);
  EXPECT_NEAR(design.variance, 0.25, 0.01);
}

TEST(VOptimalDesign, OfALineForBothEndsSharesTheTimeBetweenThem) {
  const Design design = v_optimal(line({0.0, 0.5, 1.0}), line({0.0, 1.0}), nothing_known, 1.0);
  EXPECT_NEAR(design.share[0], 0.5, 1e-4);
  EXPECT_NEAR(design.share[2], 0.5, 1e-4);
  EXPECT_NEAR(design.variance, 2.0, 1e-3);
}

TEST(VOptimalDesign, ExtrapolationTakesMoreTimeAtTheNearEnd) {
  // Target at x = 2, data at 0 and 1: y(2) = 2 y(1) - y(0), so the shares go as 2 : 1
  // (Hoel and Levine 1964), and the variance is (2 + 1)^2 per second.
  const Design design = v_optimal(line({0.0, 1.0}), line({2.0}), nothing_known, 1.0);
  EXPECT_NEAR(design.share[1], 2.0 / 3.0, 1e-4);
  EXPECT_NEAR(design.variance, 9.0, 1e-3);
}

TEST(VOptimalDesign, WhatIsKnownAlreadyIsNotMeasuredAgain) {
  // y(0) known to 1e-3: only y(1) is worth the time.
  const std::vector<double> known{1e6, 0.0, 0.0, 0.0};
  const Design design = v_optimal(line({0.0, 1.0}), line({0.0, 1.0}), known, 1.0);
  EXPECT_GT(design.share[1], 0.99);
}

TEST(VOptimalDesign, ScalesOfTheCoefficientsDoNotMatter) {
  const List candidates{{1.0, 1e-6}, {1.0, 2e-6}, {1.0, 4e-6}};
  const List targets{{1.0, 1e-6}, {1.0, 4e-6}};
  const Design design = v_optimal(candidates, targets, nothing_known, 1.0);
  EXPECT_NEAR(design.share[0], 0.5, 1e-3);
  EXPECT_NEAR(design.variance, 2.0, 1e-2);
}

TEST(VOptimalDesign, OneCandidateCannotTellTwoCoefficients) {
  const Design design = v_optimal(line({0.5}), line({0.0}), nothing_known, 1.0);
  EXPECT_TRUE(std::isinf(design.variance));
}

TEST(VOptimalDesign, RefusesListsThatDoNotFit) {
  EXPECT_THROW(v_optimal({}, line({0.0}), nothing_known, 1.0), std::invalid_argument);
  EXPECT_THROW(v_optimal(line({0.0}), List{{1.0}}, nothing_known, 1.0), std::invalid_argument);
  EXPECT_THROW(v_optimal(line({0.0}), line({1.0}), {}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace grainlaw::calibration
