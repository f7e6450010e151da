#include "calibration/band_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/continuum/example_laws.h"
#include "tests/support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

using continuum::ShearBand;
using continuum::ShearBandCase;

continuum::RheologyTable table() {
  return continuum::table_of(continuum::frictional_spheres());
}

ShearBandCase walls() {
  return {.flow = continuum::PlaneShear{
              .drive = {.velocity = 2.0}, .extent = {.mass_per_area = 12.0}, .load = 10.0}};
}

ShearBandCase box() {
  return {.flow = continuum::BodyForceBox{
              .extent = {.mass_per_area = 20.0}, .amplitude = 1.5, .pressure = 10.0}};
}

/// Rows as wide as `width` that show a profile; the row at z shows what the profile has at
/// `seen(z)`.
template <class Seen>
dem::LocalData rows_of(const continuum::Profile& profile, double height, double width, Seen seen) {
  dem::LocalData data;
  data.name = "band";
  data.window.steady = true;
  const std::vector<dem::LocalRow> none;
  for (double z = 0.5 * width; z < height; z += width) {
    dem::LocalRow at;
    at.z = seen(z);
    const Predicted values = predict_at(profile, {at});
    dem::LocalRow row;
    row.z = z;
    row.velocity = {values.velocity[0], 0.01};
    row.volume_fraction = {values.volume_fraction[0], 0.001};
    row.normal_stress = {10.0, 0.01};
    row.shear_stress = {10.0 * values.friction[0], 0.01};
    row.friction = {values.friction[0], 0.001};
    row.inertial_number = {0.1, 0.001};
    data.rows.push_back(row);
  }
  return data;
}

TEST(BandComparison, APredictionHasNoErrorAgainstItself) {
  const ShearBand band = continuum::shear_band(table(), walls());
  const double height = band.profile.height;
  const auto data = rows_of(band.profile, height, height / 20.0, [](double z) { return z; });
  const BandComparison same = compare_band(data, walls(), band);
  EXPECT_NEAR(same.profile.velocity.value, 0.0, 1e-14);
  EXPECT_NEAR(same.profile.volume_fraction.value, 0.0, 1e-14);
  EXPECT_NEAR(same.drive_difference.value, 0.0, 1e-12);
  // Without gravity the velocity is linear, so its interpolation is exact: 90 % of the height.
  EXPECT_NEAR(same.width.value, 0.9 * height, 1e-9 * height);
  EXPECT_NEAR(band.band_width, 0.9 * height, 1e-3 * height);
  ASSERT_TRUE(same.no_slip);
  EXPECT_NEAR(same.no_slip->lower, 0.0, 1e-6);
  EXPECT_NEAR(same.no_slip->upper, 0.0, 1e-6);
  EXPECT_NEAR(same.budget.geometry, 0.0, 1e-6);
}

TEST(BandComparison, WallsThatHoldGrainsElsewhereAreFoundAsNoSlipHeights) {
  const ShearBand band = continuum::shear_band(table(), walls());
  const double height = band.profile.height;
  constexpr double lower = 0.6, upper = 0.9;
  // Rows show the predicted shape squeezed between the two heights.
  const auto data = rows_of(band.profile, height, height / 24.0, [&](double z) {
    return height * (z - lower) / (height - lower - upper);
  });
  const BandComparison shifted = compare_band(data, walls(), band);
  ASSERT_TRUE(shifted.no_slip);
  EXPECT_NEAR(shifted.no_slip->lower, lower, 1e-4);
  EXPECT_NEAR(shifted.no_slip->upper, upper, 1e-4);
  // All of the error is geometry then.
  EXPECT_NEAR(shifted.budget.geometry, shifted.budget.total, 1e-4 * shifted.budget.total);
  EXPECT_LT(shifted.budget.rest(), shifted.budget.total);
}

TEST(BandComparison, AShapeThatIsOffIsNotTakenForTheWalls) {
  const ShearBand band = continuum::shear_band(table(), walls());
  const double height = band.profile.height;
  // A band at the upper wall, as a nonlocal flow under gravity has it.
  const double row_width = height / 48.0;
  auto data = rows_of(band.profile, height, row_width, [](double z) { return z; });
  for (dem::LocalRow& row : data.rows) row.velocity.value = 2.0 * std::exp((row.z - height) / 1.5);
  const BandComparison off = compare_band(data, walls(), band);
  EXPECT_FALSE(off.no_slip);
  EXPECT_EQ(off.budget.geometry, 0.0);
  // Linear between rows: h^2/8 u'' / u' with u'' up to exp(h / 1.5) of that at the place found.
  const double interpolation = row_width * row_width / (8.0 * 1.5) * std::exp(row_width / 1.5);
  EXPECT_NEAR(off.width.value, 1.5 * std::log(10.0), interpolation);
}

TEST(BandComparison, ABoxIsSeenAtRestAndInItsOwnPeriod) {
  const ShearBand band = continuum::shear_band(table(), box());
  ASSERT_TRUE(flows(band.answer.outcome)) << band.answer.text;
  const double predicted = band.profile.height;
  const double height = 0.97 * predicted;  // the grains pack denser than the law says
  constexpr int rows = 40;
  auto data = rows_of(
      band.profile, height, height / rows, [&](double z) { return z * predicted / height; });
  data.frames.periodic = true;
  data.frames.bin_width = height / rows;
  data.frames.frames.push_back({.begin = 0.0, .end = 1.0, .samples = 1, .bins = {}});
  data.frames.frames[0].bins.resize(rows);
  for (dem::LocalRow& row : data.rows) row.velocity.value += 3.0;  // the box drifts
  data.window = {.steady = true, .begin = 2.0, .end = 3.0, .reason = ""};
  const BandComparison same = compare_band(data, box(), band);
  EXPECT_NEAR(same.profile.velocity.value, 0.0, 1e-4);  // rows of the mean against the profile
  EXPECT_NEAR(same.height, height, 1e-9);
  // Rows of 1/40 of the period find the largest velocity and 90 % of it to half a row.
  EXPECT_NEAR(same.drive_difference.value, 0.0, 5e-3);
  EXPECT_NEAR(same.width.value, band.band_width * height / predicted, 0.5 * height / rows);
  EXPECT_EQ(same.budget.geometry, 0.0);
}

TEST(BandComparison, PointsOfAFitLieOffTheWallsAndTwiceTheKernelApart) {
  const ShearBand band = continuum::shear_band(table(), walls());
  auto data = rows_of(band.profile, band.profile.height, 0.5, [](double z) { return z; });
  data.frames.kernel = {dem::KernelShape::lucy, 1.0};
  const auto points = band_points(data, walls(), band.profile.height);
  ASSERT_GE(points.size(), 2u);
  EXPECT_GE(points.front().position, 2.0);
  EXPECT_LE(points.back().position, data.rows.back().z + 0.25 - 2.0);
  for (std::size_t i = 1; i < points.size(); ++i)
    EXPECT_GE(points[i].position - points[i - 1].position, 2.0 - 1e-9);
}

TEST(BandComparison, WhatDoesNotFlowIsNotCompared) {
  ShearBandCase still = box();
  std::get<continuum::BodyForceBox>(still.flow).amplitude = 0.1;
  const ShearBand band = continuum::shear_band(table(), still);
  ASSERT_FALSE(flows(band.answer.outcome));
  EXPECT_NE(testing::failure([&] { compare_band({}, still, band); }).find("no profile"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::calibration
