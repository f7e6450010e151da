#include "calibration/cohesion_series.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/ratio_of_law.h"
#include "support/calibration_checks.h"
#include "support/synthetic_chute.h"

namespace grainlaw::calibration {
namespace {

using testing::mentions;
using testing::SyntheticChute;

constexpr double mu0 = 0.365;
constexpr double beta = 0.6;

/// A chute of a material tau = c0 + mu(I) p, close to the base the law a, b = 0.
SyntheticChute chute(double degrees, double cohesion, std::uint64_t seed) {
  SyntheticChute result;
  result.name = "theta" + std::to_string(static_cast<int>(degrees)) + "_c" +
                std::to_string(static_cast<int>(10.0 * cohesion));
  result.inclination = degrees * std::numbers::pi / 180.0;
  const double tangent = std::tan(result.inclination);
  result.a = testing::bagnold_coefficient((tangent - mu0) / beta, result.inclination);
  result.tau_c = cohesion * tangent / (tangent - mu0);
  result.velocity_noise = 2e-3;
  result.stress_noise = 1e-3;
  result.seed = seed;
  return result;
}

dem::LocalData run(const SyntheticChute& chute, double attraction) {
  dem::LocalData data = testing::local_data(chute);
  data.conditions.attraction = attraction;
  return data;
}

std::vector<dem::LocalData> without_cohesion() {
  return {run(chute(22, 0, 1), 0), run(chute(23, 0, 2), 0), run(chute(25, 0, 3), 0)};
}

CohesionSeries series_of(const std::vector<dem::LocalData>& runs) {
  std::vector<SeriesRun> entries;
  for (const dem::LocalData& data : runs) entries.push_back({"cohesion", &data});
  return cohesion_series(entries);
}

TEST(CohesionSeries, TwoTiltsShowOneCohesion) {
  auto runs = without_cohesion();
  runs.push_back(run(chute(23, 0.6, 4), 8.6));
  runs.push_back(run(chute(25, 0.6, 5), 8.6));
  const CohesionSeries series = series_of(runs);
  ASSERT_TRUE(series.mu0);
  EXPECT_NEAR(series.mu0->value, mu0, 4.0 * series.mu0->error);
  ASSERT_EQ(series.pooled.size(), 1u);
  EXPECT_EQ(series.pooled[0].tilts, 2);
  EXPECT_NEAR(series.pooled[0].cohesion.value, 0.6, 4.0 * series.pooled[0].cohesion.error);
  EXPECT_LT(series.pooled[0].cohesion.error, 0.06);
  EXPECT_GT(series.pooled[0].chance, 1e-3);
}

TEST(CohesionSeries, WeightOfThePlugAndPairsGiveOneYieldStress) {
  const CohesionSeries series = series_of({run(chute(23, 0.6, 4), 8.6)});
  ASSERT_EQ(series.points.size(), 1u);
  const CohesivePoint& point = series.points[0];
  ASSERT_TRUE(point.plug);
  const double tau_c = chute(23, 0.6, 4).tau_c;
  // gd = 5 % of the largest lies at tau - tau_c = 0.25 % of its largest, 0.05: less than a row,
  // 0.43.
  EXPECT_NEAR(point.plug->yield_stress_from_weight.value, tau_c, 0.5);
  EXPECT_NEAR(point.yield_stress.value, tau_c, 4.0 * point.yield_stress.error);
  EXPECT_LT(point.flowing_height(), point.layer_height - 3.0);
}

TEST(CohesionSeries, GrainsWithoutCohesionShowNoYieldStress) {
  for (const CohesivePoint& point : series_of(without_cohesion()).points) {
    EXPECT_FALSE(point.plug) << point.name;
    EXPECT_LE(point.yield_stress.value, 3.0 * point.yield_stress.error) << point.name;
  }
}

TEST(CohesionSeries, ValuesThatDifferAreNotOneCohesion) {
  auto runs = without_cohesion();
  runs.push_back(run(chute(23, 0.6, 4), 8.6));
  runs.push_back(run(chute(25, 1.2, 5), 8.6));
  const CohesionSeries series = series_of(runs);
  ASSERT_EQ(series.pooled.size(), 1u);
  EXPECT_LT(series.pooled[0].chance, 0.01);
}

TEST(CohesionSeries, AnotherSeriesIsAnotherMaterial) {
  auto runs = without_cohesion();
  runs.push_back(run(chute(23, 0.6, 4), 8.6));
  runs.push_back(run(chute(25, 1.2, 5), 8.6));
  std::vector<SeriesRun> entries;
  for (const dem::LocalData& data : runs) entries.push_back({"cohesion", &data});
  entries.back().series = "friction bounded otherwise";
  const CohesionSeries series = cohesion_series(entries);
  ASSERT_EQ(series.pooled.size(), 2u);
  EXPECT_EQ(series.pooled[0].tilts, 1);
  EXPECT_EQ(series.pooled[1].tilts, 1);
}

TEST(CohesionSeries, WithoutThreeLooseChutesThereIsNoMu0) {
  const CohesionSeries series = series_of({run(chute(23, 0.6, 4), 8.6)});
  EXPECT_FALSE(series.mu0);
  EXPECT_TRUE(series.pooled.empty());
  EXPECT_TRUE(std::isnan(series.points[0].cohesion.value));
  EXPECT_TRUE(mentions(series.left_out, "three chutes without cohesion"));
}

/// mu0 + beta I for rigid grains, with a yield stress from cohesion f_B = 1 + alpha Bo.
continuum::RheologyTable law(double alpha) {
  continuum::MuPhi law;
  law.friction = {.mu0 = mu0, .beta = beta, .kappa = 0.0};
  law.volume_fraction = {.phi0 = 0.58, .I_phi = 1e6};
  if (alpha > 0.0) law.cohesion_friction = continuum::CohesionFriction{.alpha = alpha, .beta = 1.0};
  continuum::RheologyTable table;
  table.law = law;
  return table;
}

TEST(RatioOfLaw, ALawWithoutSoftnessOrCohesionHasNoLinearStress) {
  const continuum::RheologyTable table = law(0.0);
  for (const dem::LocalData& data : without_cohesion()) {
    const auto ratio = ratio_of_law(data, table);
    ASSERT_TRUE(ratio) << data.name;
    EXPECT_LT(*ratio, 1e-3) << data.name;
  }
}

// tau = c0 + mu(I) p makes tau - tau_c = tan(theta)/(2 K^2) (gd^2 + gd sqrt(gd^2 + 4 K^2 P_c)) with
// K = (tan(theta) - mu0)/beta, P_c = c0/(tan(theta) - mu0): where the shear is fast the root adds
// half as much linear stress as quadratic one at gd^2 = 4 K^2 P_c, and more where it is slower.
TEST(RatioOfLaw, CohesionAloneMakesALinearStress) {
  const continuum::RheologyTable table = law(0.2);
  const auto weak = ratio_of_law(run(chute(25, 0.3, 4), 4.0), table);
  const auto strong = ratio_of_law(run(chute(25, 0.6, 5), 8.0), table);
  ASSERT_TRUE(weak && strong);
  EXPECT_GT(*weak, 0.05);
  EXPECT_GT(*strong, *weak);
}

}  // namespace
}  // namespace grainlaw::calibration
