// I, Bo and T* of rows and their errors: of ratios of fields that scatter together.
#include <gtest/gtest.h>

#include <cmath>

#include "dem/local_data.h"

namespace grainlaw::dem {
namespace {

constexpr double density = 2.0;

/// Numbers in (-1, 1) without a pattern.
double scatter(int k, double irrational) {
  return std::sin(2.0 * 3.141592653589793 * irrational * (k + 1.0));
}

/// A gas without contacts in a sheared box, p = rho_p phi T, whose phi and T fluctuate.
ProfileFrames gas(int count) {
  ProfileFrames gas{.frames = {}, .kernel = {KernelShape::lucy, 0.0}};
  for (int k = 0; k < count; ++k) {
    ProfileFrame& frame = gas.frames.emplace_back();
    frame.begin = k;
    frame.end = k + 1.0;
    frame.samples = 10;
    BinMoments& bin = frame.bins.emplace_back();
    const double phi = 0.3 * (1.0 + 0.05 * scatter(k, std::sqrt(2.0)));
    const double temperature = 4.0 * (1.0 + 0.2 * scatter(k, std::sqrt(3.0)));
    bin.mass = density * phi;
    for (int a = 0; a < 3; ++a) {
      bin.momentum_flux[static_cast<std::size_t>(a)] = bin.mass * temperature;
    }
  }
  return gas;
}

ChuteConditions sheared(double attraction) {
  return {.geometry = "simple_shear",
          .gravity = 1.0,
          .grain_diameter = 1.5,
          .grain_density = density,
          .stiffness = 100.0,
          .attraction = attraction,
          .shear_rate = 0.5};
}

LocalRow row_of(double attraction) {
  const ProfileFrames frames = gas(400);
  const auto rows = average(frames, sheared(attraction), {.begin = 0.0, .end = 400.0});
  EXPECT_EQ(rows.size(), 1u);
  return rows.at(0);
}

double relative_error(const Estimate& x) {
  return x.error / x.value;
}
// Fields are linearised by steps of 1e-5 towards frames 0.2 away.
constexpr double linearisation = 1e-4;

TEST(DimensionlessRows, GasHasTheInverseVolumeFractionForTStarAndItsErrorAlone) {
  const LocalRow row = row_of(0.0);
  const double phi = row.volume_fraction.value;
  // p = rho_p phi T: what T and p have in common goes.
  EXPECT_NEAR(row.scaled_temperature.value, 1.0 / phi, 1e-12 / phi);
  const double expected = relative_error(row.volume_fraction);
  EXPECT_NEAR(relative_error(row.scaled_temperature), expected, linearisation * expected);
}

TEST(DimensionlessRows, BondNumberIsAsUncertainAsThePressure) {
  const LocalRow row = row_of(3.0);
  const double p = row.normal_stress.value;
  EXPECT_NEAR(row.bond_number.value, 3.0 / (p * 1.5 * 1.5), 1e-12);
  const double expected = relative_error(row.normal_stress);
  EXPECT_NEAR(relative_error(row.bond_number), expected, linearisation * expected);
  EXPECT_EQ(row.bond_number.effective_samples, row.normal_stress.effective_samples);
}

TEST(DimensionlessRows, GrainsThatDoNotAttractHaveNoBondNumber) {
  EXPECT_TRUE(std::isnan(row_of(0.0).bond_number.value));
}

// I = gd d sqrt(rho_p/p) with the imposed rate, p = rho_p phi T: I sqrt(phi) = gd d / sqrt(T).
TEST(DimensionlessRows, BulkInertialNumberOfAGasHangsOnItsTemperatureAlone) {
  const LocalRow row = row_of(0.0);
  const double T = row.normal_stress.value / (density * row.volume_fraction.value);
  EXPECT_NEAR(row.bulk_inertial_number.value, 0.5 * 1.5 / std::sqrt(T), 1e-12);
  const double expected = 0.5 * relative_error(row.temperature);
  EXPECT_NEAR(relative_error(row.bulk_inertial_number), expected, linearisation * expected);
}

}  // namespace
}  // namespace grainlaw::dem
