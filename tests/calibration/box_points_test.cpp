#include "calibration/box_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/calibration_checks.h"
#include "support/synthetic_box.h"

namespace grainlaw::calibration {
namespace {

using testing::failure;
using testing::local_data;
using testing::SyntheticBox;

TEST(BoxPoint, StateOfABoxIsThatOfItsStressAndDensity) {
  const SyntheticBox box{.bond_number = 1.5, .friction = 0.37, .volume_fraction = 0.59};
  const StatePoint point = box_point(local_data(box));
  EXPECT_NEAR(point.inertial_number.value, box.inertial_number, 1e-14);
  EXPECT_NEAR(point.softness.value, box.softness, 1e-15);
  EXPECT_NEAR(point.bond_number.value, box.bond_number, 1e-13);
  EXPECT_NEAR(point.friction.value, box.friction, 1e-14);
  EXPECT_NEAR(point.volume_fraction.value, box.volume_fraction, 1e-14);
  EXPECT_EQ(point.run, box.name);
  EXPECT_EQ(point.unfit, "");
}

TEST(BoxPoint, ErrorsAreThoseOfMeansOverIndependentFrames) {
  const SyntheticBox box{.friction_noise = 0.03, .fraction_noise = 0.01, .frames = 4000};
  const StatePoint point = box_point(local_data(box));
  // 4000 frames make some 200 blocks, whose scatter is known to a twentieth: four of these.
  const double root = std::sqrt(4000.0);
  EXPECT_NEAR(point.friction.error, 0.03 * box.friction / root, 0.2 * 0.03 * box.friction / root);
  EXPECT_NEAR(point.volume_fraction.error,
              0.01 * box.volume_fraction / root,
              0.2 * 0.01 * box.volume_fraction / root);
}

TEST(BoxPoint, FrictionAndVolumeFractionShareTheirNoise) {
  for (const double correlation : {-0.7, 0.0, 0.7}) {
    const StatePoint point = box_point(local_data({.friction_noise = 0.03,
                                                   .fraction_noise = 0.01,
                                                   .correlation = correlation,
                                                   .frames = 4000}));
    // (1 - r^2) / sqrt(200 blocks), four of these.
    EXPECT_NEAR(point.correlation, correlation, 4.0 * (1.0 - correlation * correlation) / 14.0);
  }
}

TEST(BoxPoint, BandThatTakesMostOfTheShearIsNoHomogeneousState) {
  EXPECT_EQ(box_point(local_data({.slope_deviation = 0.1})).unfit, "");
  const std::string reason = box_point(local_data({.slope_deviation = 0.3})).unfit;
  EXPECT_NE(reason.find("not homogeneous"), std::string::npos) << reason;
  // 0.3 sqrt(5): the share that a band at a random place would have.
  EXPECT_NE(reason.find("67 %"), std::string::npos) << reason;
}

TEST(BoxPoint, StepAtARandomPlaceChangesTheSlopeByOneOverRootFive) {
  // The line through u = 0 below c and u = gd L above: its slope over gd, less 1, by quadrature.
  double squares = 0.0;
  const int places = 1000;
  for (int i = 0; i < places; ++i) {
    const double c = (i + 0.5) / places - 0.5;
    const double slope = 12.0 * 0.5 * (0.25 - c * c);  // cov(y, u) / var(y), y in [-1/2, 1/2]
    squares += (slope - 1.0) * (slope - 1.0) / places;
  }
  EXPECT_NEAR(std::sqrt(squares), 1.0 / std::sqrt(5.0), 1e-5);
}

TEST(BoxPoint, UnsteadyBoxIsNotFittedAndSaysWhy) {
  dem::LocalData data = local_data({});
  data.window.steady = false;
  data.window.reason = "drifting";
  EXPECT_EQ(box_point(data).unfit, "not steady: drifting");
}

TEST(BoxPoint, ChuteHasNoSingleState) {
  dem::LocalData data = local_data({});
  data.conditions.geometry = "chute";
  EXPECT_NE(failure([&] { box_point(data); }).find("no simple shear"), std::string::npos);
}

TEST(BoxPoint, ShorterRunCostsItsStartAndTheShareOfTheRest) {
  const dem::LocalData part = shortened(local_data({.frames = 64}), 0.25);
  EXPECT_EQ(dem::frames_inside(part.frames, part.window).size(), 16u);
  EXPECT_DOUBLE_EQ(part.summary.wall_seconds, 2.0 + 0.25 * 8.0);
}

/// A periodic box sheared to and fro, gd = cos(2 pi y / L), without frames.
dem::LocalData sheared_both_ways(int rows) {
  dem::LocalData data;
  data.name = "kolmogorov";
  data.conditions.geometry = "body_force_box";
  data.frames = {.frames = {}, .periodic = true, .kernel = {dem::KernelShape::lucy, 1.0}};
  data.window.steady = true;
  for (int k = 0; k < rows; ++k) {
    dem::LocalRow row;
    row.z = k + 0.5;
    const double rate = std::cos(2.0 * std::numbers::pi * row.z / rows);
    row.velocity = {0.0, 0.0};
    row.shear_rate = {rate, 0.1};
    row.friction = {0.5 * rate, 0.01};
    row.inertial_number = {0.2 * rate, 0.02};
    row.normal_stress = {1.0, 0.0};
    row.volume_fraction = {0.58, 0.001};
    data.rows.push_back(row);
  }
  return data;
}

TEST(ProfilePoints, RowsAreTwoKernelWidthsApartAroundThePeriod) {
  for (const int rows : {20, 21}) {
    const ProfilePoints found = profile_points(sheared_both_ways(rows));
    ASSERT_GE(found.points.size(), 4u);
    for (std::size_t k = 0; k < found.points.size(); ++k) {
      const bool last = k + 1 == found.points.size();
      const double next = last ? found.points.front().place + rows : found.points[k + 1].place;
      EXPECT_GE(next - found.points[k].place, 2.0 - 1e-12);
    }
  }
}

TEST(ProfilePoints, BothWaysOfShearAreOneState) {
  for (const StatePoint& point : profile_points(sheared_both_ways(20)).points) {
    EXPECT_GT(point.inertial_number.value, 0.06);  // three errors of the shear rate, 0.3 of 1
    EXPECT_NEAR(point.friction.value, 2.5 * point.inertial_number.value, 1e-14);
  }
}

TEST(ProfilePoints, BondNumberHasTheRelativeErrorOfTheStressOfItsRow) {
  dem::LocalData data = sheared_both_ways(20);
  data.conditions.attraction = 0.5;
  for (dem::LocalRow& row : data.rows) row.normal_stress = {2.0, 0.1};
  for (const StatePoint& point : profile_points(data).points) {
    EXPECT_DOUBLE_EQ(point.bond_number.value, 0.25);
    EXPECT_DOUBLE_EQ(point.bond_number.error, 0.25 * 0.05);
  }
}

TEST(ProfilePoints, RowsAtWallsAreLeftOut) {
  dem::LocalData data = sheared_both_ways(20);
  data.conditions.geometry = "plane_shear";
  data.frames.periodic = false;
  dem::LocalRow beyond = data.rows.front();  // the kernel still sees grains
  beyond.z = -0.5;
  beyond.volume_fraction.value = 0.1;
  data.rows.insert(data.rows.begin(), beyond);
  const ProfilePoints found = profile_points(data);
  ASSERT_FALSE(found.points.empty());
  for (const StatePoint& point : found.points) {
    EXPECT_GE(point.place, 2.0);
    EXPECT_LE(point.place, 18.0);
  }
}

TEST(StatePoints, RunsOfOtherGeometriesAreNamed) {
  dem::LocalData chute = local_data({.name = "chute"});
  chute.conditions.geometry = "chute";
  std::vector<std::string> left_out;
  const std::vector<dem::LocalData> runs{local_data({}), chute};
  EXPECT_EQ(state_points(runs, left_out).size(), 1u);
  ASSERT_EQ(left_out.size(), 1u);
  EXPECT_NE(left_out.front().find("'chute'"), std::string::npos) << left_out.front();
}

}  // namespace
}  // namespace grainlaw::calibration
