#include "calibration/ordered_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace grainlaw::calibration {
namespace {

/// Seeds of one state with normal scatter, as an hour of boxes of 500 equal grains at I = 0.1 had.
std::vector<StatePoint> seeds(int count, double inertial_number, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<StatePoint> points;
  for (int k = 0; k < count; ++k)
    points.push_back({.name = "box",
                      .inertial_number = {inertial_number * (1.0 + 1e-3 * normal(random)), 1e-4},
                      .softness = {1e-4, 1e-7},
                      .friction = {0.4235 + 0.0026 * normal(random), 0.0026},
                      .volume_fraction = {0.574 + 0.0006 * normal(random), 0.0006}});
  return points;
}

long marked(const std::vector<StatePoint>& points) {
  return std::ranges::count_if(points, [](const StatePoint& p) { return !p.unfit.empty(); });
}

TEST(OrderedBoxes, AreMarkedAmongSeedsOfTheirState) {
  std::vector<StatePoint> points = seeds(20, 0.1, 1);
  points[7].friction.value = 0.351;
  points[7].volume_fraction.value = 0.5918;
  mark_ordered(points);
  EXPECT_EQ(marked(points), 1);
  EXPECT_NE(points[7].unfit.find("ordered"), std::string::npos) << points[7].unfit;
}

TEST(OrderedBoxes, NormalScatterMarksNone) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::vector<StatePoint> points = seeds(50, 0.1, seed);
    mark_ordered(points);
    EXPECT_EQ(marked(points), 0) << seed;
  }
}

/// Less friction alone, or more density alone, is no order; nor is another state.
TEST(OrderedBoxes, BothSignsAreNeededAndFourOthers) {
  std::vector<StatePoint> points = seeds(20, 0.1, 2);
  points[0].friction.value = 0.3;
  points[1].volume_fraction.value = 0.62;
  mark_ordered(points);
  EXPECT_EQ(marked(points), 0);
  std::vector<StatePoint> few = seeds(4, 0.1, 3);
  few[0].friction.value = 0.3;
  few[0].volume_fraction.value = 0.62;
  std::vector<StatePoint> others = seeds(20, 0.2, 3);
  few.insert(few.end(), others.begin(), others.end());
  mark_ordered(few);
  EXPECT_EQ(marked(few), 0);
}

}  // namespace
}  // namespace grainlaw::calibration
