#include "calibration/ring_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "continuum/split_bottom.h"
#include "tests/support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

constexpr RingCell cell{
    .inner_radius = 7.0, .split_radius = 38.0, .outer_radius = 50.0, .rotation_rate = 0.2};
constexpr double depth = 18.0;
constexpr double phi = 0.6;
constexpr double friction = 0.21;

double centre_at(double z) {
  return cell.split_radius * continuum::measured_surface_radius(z / cell.split_radius);
}
double width_at(double z) {
  return continuum::inner_width(z / depth, 6.0);
}

/// Fields of a band that widens upwards, as a kernel of width w shows them: an error function of
/// variance W^2 / 2 widened by the variance of kernel and cell. Errors of the share: `noise`, the
/// same in cells that share their grains.
dem::RingFields ring(double noise, unsigned seed) {
  dem::RingFields fields;
  fields.grid = {.wedge = 0.5,
                 .r_begin = 5.0,
                 .z_begin = -2.0,
                 .width = 1.0,
                 .columns = 48,
                 .rows = 24,
                 .kernel = {dem::KernelShape::lucy, 1.0}};
  const dem::RingGrid& grid = fields.grid;
  const double spread = grid.kernel.variance() + 1.0 / 12.0;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  for (std::size_t k = 0; k < grid.rows; ++k) {
    double shared = 0.0;
    for (std::size_t i = 0; i < grid.columns; ++i) {
      const double r = grid.radius(i), z = grid.height(k);
      const bool filled = z > 0.0 && z < depth && r > cell.inner_radius && r < cell.outer_radius;
      const double width = std::hypot(width_at(std::max(z, 0.5)), std::sqrt(2.0 * spread));
      if (i % 2 == 0) shared = normal(random);  // 2 w of the kernel are two cells
      const double share =
          continuum::rotation_share(r, centre_at(std::max(z, 0.0)), width) + shared;
      const double x = (r - centre_at(std::max(z, 0.0))) / width;
      dem::RingField value, error;
      value.volume_fraction = filled ? phi : 0.02;
      value.velocity = r * cell.rotation_rate * share;
      error.velocity = r * cell.rotation_rate * noise;
      value.shear_rate = r * cell.rotation_rate * std::exp(-x * x) / width;
      value.friction = friction;
      value.pressure = depth - z;
      value.inertial_number = 0.01;
      value.softness = 1e-4;
      fields.values.push_back(value);
      fields.errors.push_back(error);
    }
  }
  return fields;
}

TEST(RingBand, FindsCentreAndWidthOfTheGrainsNotOfTheKernel) {
  const RingBand band = ring_band(ring(1e-9, 1), cell, {});
  ASSERT_GE(band.rows.size(), 10u);
  for (const RingBandRow& row : band.rows) {
    EXPECT_NEAR(row.centre.value, centre_at(row.z), 1e-5) << row.z;
    EXPECT_NEAR(row.width.value, width_at(row.z), 1e-5) << row.z;
    EXPECT_NEAR(row.state.friction.value, friction, 1e-12);
    EXPECT_NEAR(
        row.fitted_shear_rate,
        centre_at(row.z) * cell.rotation_rate / (width_at(row.z) * std::sqrt(std::numbers::pi)),
        1e-5);
  }
}

TEST(RingBand, HeightsTheKernelMixesWithBottomOrSurfaceAreLeftOut) {
  const RingBand band = ring_band(ring(1e-9, 1), cell, {});
  EXPECT_NEAR(band.height, depth, 0.5);  // between two cells
  EXPECT_GE(band.rows.front().z, 2.0);
  EXPECT_LE(band.rows.back().z, band.height - 2.0);
}

TEST(RingBand, ItsErrorsCoverTheNoiseOfCellsThatShareTheirGrains) {
  double chi_squared = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    for (const RingBandRow& row : ring_band(ring(0.01, seed), cell, {}).rows) {
      const double off = (row.centre.value - centre_at(row.z)) / row.centre.error;
      chi_squared += off * off;
      ++count;
    }
  }
  // Noise of pairs of cells, which the fit does not know to be pairs: n independent deviations
  // squared have mean n and deviation sqrt(2 n); chi^2 per freedom above 1 widens some of them,
  // which lowers the sum, by no more than a third at 17 degrees of freedom.
  const double n = count;
  EXPECT_LT(chi_squared, n + 3.0 * std::sqrt(2.0 * n));
  EXPECT_GT(chi_squared, 0.67 * n - 3.0 * std::sqrt(2.0 * n));
}

TEST(RingBand, AProfileThatIsNoErrorFunctionHasALargeChiSquared) {
  dem::RingFields fields = ring(0.01, 3);
  for (std::size_t k = 0; k < fields.values.size(); ++k) {
    const double r = fields.grid.radius(k % fields.grid.columns);
    // A wide linear ramp in place of the band.
    fields.values[k].velocity = r * cell.rotation_rate * std::clamp((r - 10.0) / 38.0, 0.0, 1.0);
  }
  for (const RingBandRow& row : ring_band(fields, cell, {}).rows)
    EXPECT_GT(row.chi_squared, 2.0) << row.z;
}

TEST(RingBand, NothingToFitIsRefused) {
  EXPECT_NE(testing::failure([] { ring_band({}, cell, {}); }).find("without averages"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::calibration
