#include "calibration/nonlocal_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/continuum/example_laws.h"

namespace grainlaw::calibration {
namespace {

using namespace continuum;

RheologyTable glass_beads() {
  return table_of(MuPhi{.friction = saturating_friction(0.3819, 0.6435, 0.279),
                        .volume_fraction = {.phi0 = 0.6, .I_phi = INFINITY}});
}

ShearBandCase loaded_shear() {
  return {
      .flow = PlaneShear{
          .drive = {.velocity = 0.3}, .extent = {.height = 60.0}, .load = 10.0, .gravity = 1.0}};
}

/// Every fourth d over the upper 30 d of a band, with normal errors of 1 % of the wall velocity.
std::vector<BandPoint> measured(double amplitude, unsigned seed) {
  ShearBandCase band = loaded_shear();
  band.nonlocal_amplitude = amplitude;
  const auto profile = shear_band(glass_beads(), band, {.cells = 1600}).profile;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 0.003);
  std::vector<BandPoint> points;
  double next = 30.0;
  for (const auto& row : profile.rows) {
    if (row.z < next) continue;
    points.push_back({row.z, row.velocity + noise(random), 0.003});
    next = row.z + 1.0;
  }
  return points;
}

TEST(NonlocalFit, FindsTheAmplitudeOfABandWithinItsError) {
  double chi_squared = 0.0;
  constexpr int seeds = 8;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const NonlocalFit fit =
        fit_nonlocal_amplitude(glass_beads(), loaded_shear(), measured(0.48, seed));
    const double deviation = (fit.amplitude - 0.48) / fit.error;
    EXPECT_LT(std::abs(deviation), 4.0) << fit.amplitude << " +- " << fit.error;
    EXPECT_LT(fit.error, 0.05);
    EXPECT_GT(fit.local_chi_squared, 3.0 * fit.summary.chi_squared);
    chi_squared += deviation * deviation;
  }
  // chi^2 of 8 degrees of freedom: 1.34 to 21.95 hold 99 %
  EXPECT_GT(chi_squared, 1.34);
  EXPECT_LT(chi_squared, 21.95);
}

TEST(NonlocalFit, ABandOfUniformStressRatioDoesNotTellTheAmplitude) {
  const ShearBandCase uniform{
      .flow = PlaneShear{.drive = {.velocity = 0.3}, .extent = {.height = 20.0}, .load = 10.0}};
  std::vector<BandPoint> points;
  for (const double z : {4.0, 8.0, 12.0, 16.0}) points.push_back({z, 0.3 * z / 20.0, 0.003});
  try {
    fit_nonlocal_amplitude(glass_beads(), uniform, points);
    FAIL();
  } catch (const FitError& error) {
    EXPECT_NE(std::string(error.what()).find("does not tell"), std::string::npos) << error.what();
  }
}

/// Only A^2 enters, so a local band is found with an A whose square is nothing.
TEST(NonlocalFit, FindsNoNonlocalityInALocalBand) {
  const NonlocalFit fit = fit_nonlocal_amplitude(glass_beads(), loaded_shear(), measured(0.0, 5));
  EXPECT_LT(fit.amplitude, 0.1);
  EXPECT_LT(std::abs(fit.local_chi_squared - fit.summary.chi_squared), 4.0);
}

TEST(NonlocalFit, RefusesPointsThatFixNothing) {
  EXPECT_THROW(fit_nonlocal_amplitude(glass_beads(), loaded_shear(), {{1.0, 0.1, 0.01}}), FitError);
  EXPECT_THROW(
      fit_nonlocal_amplitude(
          glass_beads(), loaded_shear(), {{1.0, 0.1, 0.0}, {2.0, 0.1, 0.1}, {3, 1, 1}, {4, 1, 1}}),
      FitError);
}

}  // namespace
}  // namespace grainlaw::calibration
