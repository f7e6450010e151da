#include "calibration/bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calibration/mu_phi_fit.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

std::vector<dem::LocalData> campaign() {
  std::vector<dem::LocalData> runs;
  for (const double tilt : {21.0, 22.0, 23.0, 24.0, 25.0}) {
    const double inclination = tilt * std::numbers::pi / 180.0;
    const double I = continuum::inertial_number_of(0.353, 0.5, 0.0, std::tan(inclination));
    runs.push_back(testing::local_data({.name = "tilt",
                                        .inclination = inclination,
                                        .a = testing::bagnold_coefficient(I, inclination),
                                        .velocity_noise = 5.0 * I,
                                        .stress_noise = 0.01,
                                        .seed = static_cast<std::uint64_t>(tilt)}));
  }
  return runs;
}

TEST(Bootstrap, BlocksKeepNeighboursTogether) {
  const auto indices = moving_blocks(100, 10, 7);
  ASSERT_EQ(indices.size(), 100u);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_LT(indices[k], 100u);
    if (k % 10 == 0) continue;
    EXPECT_EQ(indices[k], indices[k - 1] + 1);
  }
  EXPECT_EQ(indices, moving_blocks(100, 10, 7));
  EXPECT_NE(indices, moving_blocks(100, 10, 8));
}

TEST(Bootstrap, BandOfTheFrictionLawIsAsWideAsItsCovariance) {
  const auto runs = campaign();
  const MuPhiFit fit = fit_mu_phi(runs);
  const double I = 0.15;
  const BootstrapBand band = friction_band(runs, {I});
  EXPECT_EQ(band.replicates, 200);
  const double mu = continuum::friction(std::get<continuum::MuPhi>(fit.table.law), I);
  EXPECT_LT(band.lower[0], mu);
  EXPECT_GT(band.upper[0], mu);
  const continuum::Covariance& c = *fit.table.covariance;
  const double error = std::sqrt(c(0, 0) + 2.0 * I * c(0, 1) + I * I * c(1, 1));
  // Both widths are estimates: errors of the five points rest on about 12 blocks each (1/sqrt(2 *
  // 55) together), the quantiles on 200 replicates (about 10 %), blocks cut off the series lose up
  // to a twelfth. Three of these together are 45 %; a scatter of the points above their errors
  // enlarges only the covariance.
  const double ratio = (band.upper[0] - band.lower[0]) / (2.0 * 1.96 * error);
  EXPECT_LT(ratio, 1.45);
  EXPECT_GT(ratio, 0.3);
}

}  // namespace
}  // namespace grainlaw::calibration
