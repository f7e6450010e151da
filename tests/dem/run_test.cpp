#include "dem/run.h"

#include <gtest/gtest.h>

#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// A chute on 5 d by 5 d, 6 d deep: small enough for a test, deep enough to have a bulk.
Scene flowing_chute() {
  Scene scene = small_chute(27.0, 170);
  std::get<Chute>(scene.geometry).length = 5.0;
  std::get<Chute>(scene.geometry).width = 5.0;
  scene.measurement.averaging_time = 40.0;
  scene.measurement.time_limit = 80.0;
  return scene;
}

/// Force of the base above a row, where the kernel reaches into the base.
const std::array<double, 3>& wall_force_above(const LocalData& data, const LocalRow& row) {
  const WidthFields& fields = data.fields.at(1);
  const double k = std::floor((row.z - fields.z_begin) / fields.row_width);
  return fields.values.at(static_cast<std::size_t>(k)).wall_force_above;
}

TEST(Run, StressesOfAFlowingChuteCarryItsWeight) {
  const LocalData data = run(flowing_chute());
  const double theta = data.conditions.inclination;
  int bulk = 0;
  for (const LocalRow& row : data.rows) {
    if (row.z < 0.0 || row.volume_fraction.value < 0.5) continue;
    const auto& base = wall_force_above(data, row);
    const double normal = row.mass_above * std::cos(theta) - base[2];
    const double shear = row.mass_above * std::sin(theta) + base[0];
    // Statistical error of the row and the mean acceleration left in the window: 1 %.
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

TEST(Run, RestitutionIsProbedAtTheSpeedOfTheFlowAndNotStoppedByTheGuardOfTheScene) {
  Scene scene = small_plane_shear(20.0);
  std::get<PlaneShear>(scene.geometry).velocity = 60.0;  // would press 0.3 d into each other
  scene.measurement.time_limit = 0.02;                   // it is not the run that is asked about
  scene.measurement.averaging_time = 0.02;
  scene.measurement.sample_interval = 2e-3;
  scene.measurement.frame_interval = 4e-3;
  EXPECT_NEAR(run(scene).summary.restitution, soft.restitution(0.5), 1e-3);
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

RunOptions observed_by(Observer observer) {
  RunOptions options;
  options.observer = std::move(observer);
  return options;
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
  EXPECT_TRUE(same_numbers(first, run(scene, observed_by([](const Progress&) { return true; }))));
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
  const LocalData data = run(scene, observed_by([](const Progress& p) { return p.time < 6.0; }));
  EXPECT_EQ(data.frames.frames.size(), 4u);  // told to stop after the first frame that ends past 6
  EXPECT_FALSE(data.window.steady);
}

/// The first question is asked by the packing, of any geometry.
TEST(Run, ObserverStopsARunThatIsBeingPacked) {
  for (const Scene& scene : {small_chute(25.0), small_shear(10.0, 150), small_plane_shear(10.0)}) {
    int saved = 0;
    RunOptions options = observed_by([](const Progress& p) { return !p.settling; });
    options.save = [&](const Checkpoint& checkpoint) { saved += checkpoint == Checkpoint{}; };
    const LocalData none = run(scene, options);
    EXPECT_TRUE(none.frames.frames.empty());
    EXPECT_EQ(none.summary.steps, 0);
    EXPECT_FALSE(none.window.steady);
    EXPECT_NE(none.window.reason.find("before the flow"), std::string::npos) << none.window.reason;
    EXPECT_EQ(saved, 1) << "one that begins anew";
  }
}

/// Every geometry from packing to rows, in a second or so.
TEST(Run, EveryGeometryGivesFlowingRowsAndClosesItsLedger) {
  for (Scene scene : {small_shear(std::nullopt, 150),
                      small_shear(10.0, 150),
                      small_plane_shear(10.0),
                      small_force_box(),
                      small_ring()}) {
    scene.measurement.averaging_time = 8.0;
    scene.measurement.time_limit = 10.0;
    const LocalData data = run(scene);
    EXPECT_EQ(data.conditions.geometry, kind(scene.geometry));
    EXPECT_FALSE(data.rows.empty()) << kind(scene.geometry);
    for (const LocalRow& row : data.rows) EXPECT_TRUE(std::isfinite(row.velocity.value));
    EXPECT_LE(data.summary.energy_residual, 1e-3) << kind(scene.geometry);
    EXPECT_GT(data.summary.coordination, 0.1) << kind(scene.geometry);
  }
}

TEST(Run, ShearedBoxUnderPressureKeepsItInItsRow) {
  Scene scene = small_shear(20.0, 300);
  scene.measurement.averaging_time = 20.0;
  scene.measurement.time_limit = 25.0;
  const LocalData data = run(scene);
  ASSERT_EQ(data.rows.size(), 1u);
  const LocalRow& row = data.rows.front();
  // Blocks of the window and what the piston has not yet made good of the start: 0.5 %.
  EXPECT_NEAR(row.normal_stress.value, 20.0, 4.0 * row.normal_stress.error + 0.1);
  EXPECT_DOUBLE_EQ(row.shear_rate.value, 1.0);
  EXPECT_GT(row.friction.value, 0.2);
  EXPECT_LT(row.friction.value, 1.0);
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
