#include "calibration/ring_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/continuum/example_laws.h"
#include "tests/support/calibration_checks.h"

namespace grainlaw::calibration {
namespace {

const continuum::RheologyTable table = continuum::table_of(continuum::slippery_spheres());

/// About the ring cell of Shi et al. 2020 in units d = rho_p = g = 1.
continuum::RingFlowCase ring(double amplitude) {
  return {.cell = {.split_radius = 38.6, .depth = 15.5, .rotation_rate = 0.028},
          .inner_radius = 6.7,
          .outer_radius = 50.0,
          .nonlocal_amplitude = amplitude};
}

/// What a DEM run of that law would show, its shares off by `noise` and their errors `noise`.
RingBand measured(const continuum::RingFlow& flow, double noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, noise);
  RingBand band{.height = 15.5, .rows = {}, .notes = {}};
  for (double z = 2.5; z < 13.0; z += 1.0) {
    RingBandRow row{.z = z, .centre = {}, .width = {}, .shares = {}, .state = {}};
    for (double r = 9.0; r < 48.0; r += 1.0)
      row.shares.push_back({r, flow.rotation_at(r, z) + normal(random), noise});
    const BandShape shape = band_shape(row.shares, {38.0, 5.0});
    row.centre.value = shape.centre;
    row.width.value = shape.width;
    band.rows.push_back(std::move(row));
  }
  return band;
}

TEST(RingComparison, TheFlowItselfIsOffByTheNoiseAlone) {
  const continuum::RingFlow flow = ring_flow(table, ring(0.4));
  const RingBand band = measured(flow, 0.01, 1);
  const RingComparison comparison = compare_ring(band, flow, table, ring(0.4));
  EXPECT_NEAR(comparison.in_standard_errors, 1.0, 0.1);
  EXPECT_NEAR(comparison.velocity.value, comparison.budget.statistics, 0.1 * 0.02);
  ASSERT_EQ(comparison.rows.size(), band.rows.size());
  for (std::size_t k = 0; k < band.rows.size(); ++k) {
    EXPECT_NEAR(comparison.rows[k].centre, band.rows[k].centre.value, 0.3) << band.rows[k].z;
    EXPECT_NEAR(comparison.rows[k].width, band.rows[k].width.value, 0.5) << band.rows[k].z;
  }
}

TEST(RingComparison, TheLawHasItsPartWhereTheTableStatesErrors) {
  continuum::RheologyTable with_errors = table;
  with_errors.covariance = continuum::Covariance{.names = {"mu0"}, .matrix = {1e-4}};
  const continuum::RingFlow flow = ring_flow(table, ring(0.4));
  const RingBand band = measured(flow, 1e-3, 2);
  const double law = compare_ring(band, flow, with_errors, ring(0.4)).budget.law;
  EXPECT_GT(law, 1e-4);
  EXPECT_LT(law, 0.06);  // mu0 is known to 6 %
  EXPECT_EQ(compare_ring(band, flow, table, ring(0.4)).budget.law, 0.0);
}

TEST(RingComparison, FindsTheAmplitudeOfARingCellWithinItsError) {
  const continuum::RingFlow flow = ring_flow(table, ring(0.4), {.cell_width = 0.5});
  double chi_squared = 0.0;
  constexpr int seeds = 4;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const NonlocalFit fit = fit_nonlocal_amplitude(table, ring(0.0), measured(flow, 0.01, seed));
    EXPECT_GT(fit.local_chi_squared, 3.0 * fit.summary.chi_squared);
    EXPECT_LT(fit.error, 0.05);
    chi_squared += std::pow((fit.amplitude - 0.4) / fit.error, 2);
  }
  EXPECT_LT(chi_squared, 14.9);  // 99.5 % of chi^2 with 4 degrees of freedom
}

TEST(RingComparison, NoRotationIsRefused) {
  const continuum::RingFlow flow = ring_flow(table, ring(0.4));
  const RingBand band = measured(flow, 0.01, 1);
  EXPECT_NE(testing::failure([&] { compare_ring(band, {}, table, ring(0.4)); }).find("nothing to"),
            std::string::npos);
}

}  // namespace
}  // namespace grainlaw::calibration
