#include "dem/run.h"

#include <gtest/gtest.h>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// A chute on 5 d by 5 d, 6 d deep: small enough for a test, deep enough to have a bulk.
Scene flowing_chute() {
  Scene scene = small_chute(27.0, 170);
  scene.geometry.length = 5.0;
  scene.geometry.width = 5.0;
  scene.measurement.averaging_time = 40.0;
  scene.measurement.time_limit = 80.0;
  return scene;
}

TEST(Run, StressesOfAFlowingChuteCarryItsWeight) {
  const LocalData data = run(flowing_chute());
  const double theta = data.conditions.inclination;
  int bulk = 0;
  for (const LocalRow& row : data.rows) {
    if (row.z < 0.0 || row.volume_fraction.value < 0.5) continue;
    const double normal = row.mass_above * std::cos(theta);
    const double shear = row.mass_above * std::sin(theta);
    // Statistical error of the bin, the mean acceleration left in the window, and the share of the
    // bin that layering shifts (mass_above takes the density in a bin as linear): 1 %.
    const double accelerating = 0.01 * normal;
    EXPECT_NEAR(row.normal_stress.value, normal, 4.0 * row.normal_stress.error + accelerating);
    EXPECT_NEAR(row.shear_stress.value, shear, 4.0 * row.shear_stress.error + accelerating);
    EXPECT_NEAR(row.friction.value, std::tan(theta), 4.0 * row.friction.error + 0.01);
    EXPECT_GT(row.shear_rate.value, 0.0);
    EXPECT_GT(row.temperature.value, 0.0);
    ++bulk;
  }
  EXPECT_GE(bulk, 4);
  EXPECT_LE(data.summary.energy_residual, 1e-3);
  EXPECT_NEAR(data.summary.restitution, soft.restitution(0.5), 1e-3);
  EXPECT_EQ(data.summary.flowing_grains, 170);
  EXPECT_GT(data.summary.coordination, 0.5);
  EXPECT_LT(data.summary.largest_overlap, 0.3);
}

TEST(Run, BlockVelocitiesAverageToTheRows) {
  const LocalData data = run(flowing_chute());
  const auto blocks = block_velocities(data);
  ASSERT_GE(blocks.size(), 4u);
  for (std::size_t row = 0; row < data.rows.size(); ++row) {
    if (data.rows[row].volume_fraction.value < 0.5) continue;
    double mean = 0.0;
    for (const auto& block : blocks) mean += block[row] / static_cast<double>(blocks.size());
    // Blocks weigh equally here, by mass in the row, and leave out what is less than a block.
    EXPECT_NEAR(mean, data.rows[row].velocity.value, 2.0 * data.rows[row].velocity.error + 1e-12);
  }
}

bool same_numbers(const LocalData& a, const LocalData& b) {
  if (a.rows.size() != b.rows.size() || a.frames.frames.size() != b.frames.frames.size())
    return false;
  for (std::size_t k = 0; k < a.rows.size(); ++k) {
    if (a.rows[k].velocity.value != b.rows[k].velocity.value) return false;
    if (a.rows[k].normal_stress.error != b.rows[k].normal_stress.error) return false;
  }
  for (std::size_t k = 0; k < a.frames.frames.size(); ++k) {
    if (a.frames.frames[k].kinetic_energy != b.frames.frames[k].kinetic_energy) return false;
  }
  return a.summary.energy_residual == b.summary.energy_residual;
}

TEST(Run, SameSeedGivesTheSameNumbersAndAnotherSeedOthers) {
  Scene scene = small_chute(25.0);
  scene.measurement.averaging_time = 10.0;
  scene.measurement.time_limit = 12.0;
  const LocalData first = run(scene);
  EXPECT_TRUE(same_numbers(first, run(scene)));
  EXPECT_TRUE(same_numbers(first, run(scene, [](const Progress&) { return true; })));
  scene.seed = 2;
  EXPECT_FALSE(same_numbers(first, run(scene)));
}

TEST(Run, LayerBelowItsAngleOfReposeEndsArrestedAndEarly) {
  const LocalData data = run(small_chute(12.0));
  EXPECT_FALSE(data.window.steady);
  EXPECT_EQ(data.window.reason.substr(0, 8), "arrested") << data.window.reason;
  EXPECT_LT(data.window.end, 100.0);
}

TEST(Run, SteepLayerEndsAcceleratingBeforeTheTimeLimit) {
  const LocalData data = run(small_chute(40.0));
  EXPECT_FALSE(data.window.steady);
  EXPECT_EQ(data.window.reason.substr(0, 12), "accelerating") << data.window.reason;
  EXPECT_LT(data.window.end, 300.0);
}

TEST(Run, ObserverStopsTheRunAndKeepsItsFrames) {
  const Scene scene = small_chute(25.0);
  const LocalData data = run(scene, [](const Progress& p) { return p.time < 6.0; });
  EXPECT_EQ(data.frames.frames.size(), 4u);  // told to stop after the first frame that ends past 6
  EXPECT_FALSE(data.window.steady);
  const LocalData none = run(scene, [](const Progress& p) { return !p.settling; });
  EXPECT_TRUE(none.frames.frames.empty());
}

TEST(Run, FrictionlessGrainsRun) {
  Scene scene = small_chute(5.0);
  scene.friction = Frictionless{};
  scene.measurement.averaging_time = 10.0;
  scene.measurement.time_limit = 12.0;
  const LocalData data = run(scene);
  EXPECT_EQ(data.conditions.contact_friction, 0.0);
  EXPECT_LE(data.summary.energy_residual, 1e-3);
}

TEST(Run, StepOfTheSceneTakesMeasurableTime) {
  EXPECT_GT(measure_step_seconds(small_chute(25.0)), 0.0);
}

}  // namespace
}  // namespace grainlaw::dem
