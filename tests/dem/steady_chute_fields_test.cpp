// Do the fields of a flowing chute keep its balances?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "dem/fields.h"
#include "dem/local_data.h"
#include "dem/run.h"
#include "dem/statistics.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

/// The whole weight at once: what carries the mass above a row is the stress in it and the walls
/// above it.
double imbalance_zz(const FieldRow& row, double weight_of_mass) {
  return row.normal_stress + row.wall_force_above[2] - weight_of_mass * row.mass_above;
}
double imbalance_xz(const FieldRow& row, double pull_of_mass) {
  return row.shear_stress - row.wall_force_above[0] - pull_of_mass * row.mass_above;
}

/// A chute on 5 d by 5 d, 6 d deep, in steady flow.
const LocalData& steady_chute() {
  static const LocalData data = [] {
    Scene scene = small_chute(27.0, 170);
    std::get<Chute>(scene.geometry).length = 5.0;
    std::get<Chute>(scene.geometry).width = 5.0;
    scene.measurement.averaging_time = 100.0;
    scene.measurement.time_limit = 400.0;
    return run(scene);
  }();
  return data;
}

/// Stress, weight and walls balance where the kernel reaches into the base and above the surface
/// as they do in the bulk. The base takes the whole weight, so the rows next to it would be off by
/// all of it without the wall force.
TEST(SteadyChute, CarriesItsWeightInEveryRowAtEveryWidthOfBothKernels) {
  const LocalData& data = steady_chute();
  const double theta = data.conditions.inclination;
  const double base_pressure = data.conditions.mass_per_area * std::cos(theta);
  ASSERT_TRUE(data.window.steady) << data.window.reason;
  std::vector<WidthFields> all = data.fields;
  ASSERT_EQ(all.size(), 3u);
  ProfileFrames frames = data.frames;  // another kernel, after the fact
  frames.kernel.shape = KernelShape::gaussian;
  for (WidthFields& fields : fields_at_widths(frames, data.conditions, data.window)) {
    all.push_back(std::move(fields));
  }
  for (const WidthFields& fields : all) {
    for (std::size_t k = 0; k < fields.values.size(); ++k) {
      const FieldRow& row = fields.values[k];
      const FieldRow& error = fields.errors[k];
      const double sampling = std::hypot(error.normal_stress, error.wall_force_above[2]);
      EXPECT_LE(std::abs(imbalance_zz(row, std::cos(theta))),
                std::max(1e-3 * base_pressure, 3.0 * sampling))
          << "w = " << fields.width << ", row " << k;
      // The mean velocity may still change by three errors over the window.
      const double speeding = 3.0 * data.rows.back().velocity.error *
                              data.conditions.mass_per_area / (data.window.end - data.window.begin);
      const double pull = std::hypot(error.shear_stress, error.wall_force_above[0]);
      EXPECT_LE(std::abs(imbalance_xz(row, std::sin(theta))),
                std::max(1e-3 * base_pressure, 3.0 * pull) + speeding)
          << "w = " << fields.width << ", row " << k;
    }
  }
}

TEST(SteadyChute, FrictionIsTheSlopeThroughTheBulk) {
  const LocalData& data = steady_chute();
  const double slope = std::tan(data.conditions.inclination);
  for (const WidthFields& fields : data.fields) {
    double densest = 0.0;
    for (const FieldRow& row : fields.values) densest = std::max(densest, row.density);
    int bulk = 0;
    for (std::size_t k = 0; k < fields.values.size(); ++k) {
      if (fields.values[k].density < 0.9 * densest) continue;
      EXPECT_NEAR(fields.values[k].friction,
                  slope,
                  std::max(0.01 * slope, 3.0 * fields.errors[k].friction));
      ++bulk;
    }
    EXPECT_GE(bulk, 2);
  }
}

TEST(SteadyChute, BothPressuresAreGivenAndAgreeInADenseFlow) {
  for (const LocalRow& row : steady_chute().rows) {
    if (row.volume_fraction.value < 0.5) continue;
    // Normal stresses of dense chutes differ by up to a tenth (Silbert et al. 2001, fig. 8).
    EXPECT_NEAR(row.pressure.value, row.normal_stress.value, 0.1 * row.normal_stress.value);
    EXPECT_NE(row.pressure.value, row.normal_stress.value);
  }
}

TEST(SteadyChute, ContactsDissipateWhatGravityPutsIn) {
  // Energy balance of steady flow over the whole layer, frame by frame: g sin(theta) times the flux
  // goes into contacts. What springs of contacts still hold at their end is not in their
  // dissipation; it is lost too, and bounded by mu F delta_t / 2 of a contact.
  const LocalData& data = steady_chute();
  std::vector<double> missing;
  double work = 0.0, sliding = 0.0, dissipation = 0.0;
  for (const ProfileFrame& frame : data.frames.frames) {
    if (frame.begin < data.window.begin) continue;
    double lost = 0.0, gained = 0.0;
    for (std::size_t k = 0; k < frame.bins.size(); ++k) {
      lost += frame.bins[k].dissipation;
      gained += frame.bins[k].momentum[0] * std::sin(data.conditions.inclination);
      sliding += frame.sliding[k].dissipation;
    }
    work += gained;
    dissipation += lost;
    missing.push_back(gained - lost);
  }
  const BlockAverage average = block_average(missing);
  const double frames = static_cast<double>(missing.size());
  EXPECT_NEAR(average.mean, 0.0, 4.0 * average.error);
  EXPECT_LT(average.error, 0.05 * work / frames);  // it says something
  EXPECT_GT(sliding, 0.1 * dissipation);
  EXPECT_LT(sliding, 0.9 * dissipation);
  for (const LocalRow& row : data.rows) {
    if (row.volume_fraction.value < 0.5) continue;
    EXPECT_GT(row.sliding_share.value, 0.02);
    EXPECT_LT(row.sliding_share.value, 0.9);
    EXPECT_GT(row.dissipation.value, 0.0);
  }
}

TEST(ContactLoss, OfAllContactsIsWhatTheLedgerBooks) {
  const auto law = rough(soft, 0.5);
  const Scene scene = with(small_shear(10.0), law, 50.0);
  Simulation box = flow(scene, law);
  run_until(box, 2.0);
  const double before = box.ledger().normal_dashpot + box.ledger().slip;
  double told = 0.0, slid = 0.0;
  const double slip_before = box.ledger().slip;
  for (int k = 0; k < 50; ++k) {
    box.step([&](std::uint32_t, std::uint32_t, const Vec3&, const Vec3&, const ContactLoss& loss) {
      told += loss.all;
      slid += loss.sliding;
    });
  }
  const EnergyLedger& after = box.ledger();
  EXPECT_NEAR(told, after.normal_dashpot + after.slip - before, 1e-11 * before);
  EXPECT_NEAR(slid, after.slip - slip_before, 1e-11 * before);
  EXPECT_GT(slid, 0.0);
}

TEST(FrictionlessFlow, StoresNothingAboutSliding) {
  Scene scene = small_shear(10.0);
  scene.friction = Frictionless{};
  scene.measurement.averaging_time = 10.0;
  scene.measurement.time_limit = 20.0;
  const LocalData data = run(scene);
  for (const ProfileFrame& frame : data.frames.frames) EXPECT_TRUE(frame.sliding.empty());
  ASSERT_EQ(data.rows.size(), 1u);
  EXPECT_TRUE(std::isnan(data.rows.front().sliding_share.value));
  EXPECT_GT(data.rows.front().dissipation.value, 0.0);
}

}  // namespace
}  // namespace grainlaw::dem
