#include "dem/coarse_graining.h"

#include <gtest/gtest.h>

#include "dem/local_data.h"
#include "tests/dem/support.h"

namespace grainlaw::dem {
namespace {

using namespace test;

const Bins bins{.begin = -2.0, .width = 0.7, .area = 16.0, .count = 10};

SteadyWindow until(double end) {
  SteadyWindow window;
  window.end = end;
  return window;
}

TEST(ShareStretch, SharesOfABranchSumToOne) {
  for (const double z1 : {-1.9, -0.6, 0.1, 1.234, 4.9}) {
    for (const double z2 : {-2.0, -0.61, 0.1, 0.8, 2.9}) {
      double sum = 0.0;
      share_stretch(bins, z1, z2, [&](std::size_t k, double share) {
        EXPECT_LT(k, bins.count);
        EXPECT_GE(share, 0.0);
        sum += share;
      });
      EXPECT_NEAR(sum, 1.0, 1e-14);
    }
  }
}

TEST(ShareStretch, PartOutsideAllBinsIsLeftOut) {
  double sum = 0.0;
  share_stretch(bins, 4.0, 6.0, [&](std::size_t, double share) { sum += share; });
  EXPECT_NEAR(sum, 0.5, 1e-14);
  share_stretch(bins, 5.0, 5.0, [](std::size_t, double) { FAIL() << "top face is outside"; });
  share_stretch(bins, -3.0, -2.5, [](std::size_t, double) { FAIL() << "below all bins"; });
}

TEST(FrameSampler, SheetOfGrainsInLinearFlowHasNoTemperature) {
  // v_x = 0.7 z exactly: about the mean of a bin it would seem to fluctuate by (gd w)^2 / 12.
  InitialState initial;
  for (int k = 0; k < 350; ++k) {
    const double z = 0.02 * k - 1.99;
    initial.grains.push_back({.position = {0.0, 0.0, z}, .velocity = {0.7 * z, 0.0, 0.0}});
  }
  const Particles particles = [&] {
    Particles made = make_particles(initial, unit_density, false);
    restart_half_step(made, {});
    return made;
  }();
  FrameSampler sampler(bins.count);
  ProfileFrames frames{.z_begin = bins.begin, .bin_width = bins.width, .frames = {}};
  for (int k = 0; k < 4; ++k) {
    sampler.sample(bins, particles, {}, {});
    frames.frames.push_back(sampler.finish());
    frames.frames.back().begin = k;
    frames.frames.back().end = k + 1.0;
  }
  ChuteConditions conditions;
  conditions.grain_density = 1.0;
  conditions.stiffness = 1.0;
  const auto rows = average(frames, conditions, until(4.0));
  ASSERT_EQ(rows.size(), 10u);
  for (const LocalRow& row : rows) {
    EXPECT_NEAR(row.temperature.value, 0.0, 1e-14);
    EXPECT_NEAR(row.shear_rate.value, 0.7, 1e-13);
    EXPECT_NEAR(row.velocity.value, 0.7 * row.z, 1e-13);
    EXPECT_NEAR(row.velocity.error, 0.0, 1e-9);
  }
}

/// A column settled on its base at zero tilt, sampled at every step for a while after.
struct Settled {
  ProfileFrames frames;
  ChuteConditions conditions;
  double largest_mean_acceleration = 0.0;  // that the motion left over allows, in units of g
};

Settled settle_column() {
  const Scene scene = small_chute(0.0, 150);
  Simulation simulation = flow(with(scene, rough(soft, 0.5), 50.0), rough(soft, 0.5));
  while (simulation.time() < 12.0) simulation.step();
  const Bins column{.begin = -3.0, .width = 0.5, .area = 16.0, .count = 30};
  FrameSampler sampler(column.count);
  Settled settled;
  settled.frames = {column.begin, column.width, {}};
  settled.conditions.grain_density = scene.grains.density();
  settled.conditions.stiffness = soft.stiffness;
  settled.conditions.mass_per_area = 150.0 / 16.0;
  const double start = simulation.time();
  const double speed = std::sqrt(2.0 * simulation.kinetic_energy() / 150.0);
  std::vector<ContactSample> contacts;
  while (simulation.time() < start + 3.0) {
    contacts.clear();
    simulation.step([&](std::uint32_t i, std::uint32_t j, const Vec3& branch, const Vec3& force) {
      contacts.push_back({i, j, branch, force});
    });
    sampler.sample(column, simulation.particles(), simulation.setup().dynamics, contacts);
  }
  settled.largest_mean_acceleration = 2.0 * speed / (simulation.time() - start);
  settled.frames.frames = {sampler.finish()};
  settled.frames.frames.front().end = 1.0;
  return settled;
}

TEST(FrameSampler, NormalStressOfASettledLayerIsTheWeightAbove) {
  const Settled settled = settle_column();
  const auto& bins_of_column = settled.frames.frames.front().bins;
  const double width = settled.frames.bin_width;
  EXPECT_LT(settled.largest_mean_acceleration, 0.01);
  int compared = 0;
  for (const LocalRow& row : average(settled.frames, settled.conditions, until(1.0))) {
    if (row.z < 0.0) continue;  // base contacts lie below z = 0
    // The weight above, averaged over the bin: a grain in it counts by the share of the bin below.
    const auto bin = static_cast<std::size_t>((row.z - settled.frames.z_begin) / width);
    double above = 0.5 * width * bins_of_column[bin].mass + bins_of_column[bin].mass_offset;
    for (std::size_t k = bin + 1; k < bins_of_column.size(); ++k) {
      above += width * bins_of_column[k].mass;
    }
    // Momentum balance: the rest is the mean acceleration of what is above, at most
    // 2 v / T with v the root mean square speed at the start (it only falls).
    const double total = settled.conditions.mass_per_area;
    EXPECT_NEAR(row.normal_stress.value, above, settled.largest_mean_acceleration * total)
        << "z = " << row.z;
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(FrameSampler, StressOfAShearedBoxIsTheOneThePistonFeels) {
  const auto law = rough(soft, 0.5);
  const Scene scene = with(small_shear(10.0), law, 50.0);
  Simulation box = flow(scene, law);
  run_until(box, 2.0);
  const std::size_t count = 1;
  for (int k = 0; k < 20; ++k) {
    std::vector<ContactSample> contacts;
    const Dynamics before = box.setup().dynamics;
    box.step([&](std::uint32_t i, std::uint32_t j, const Vec3& branch, const Vec3& force) {
      contacts.push_back({i, j, branch, force});
    });
    FrameSampler sampler(count);
    sampler.sample(profile_bins(scene, box.box()), box.particles(), before, contacts);
    const BinMoments moments = sampler.finish().bins.front();
    const double kinetic = moments.momentum_flux[1];
    const double contact = moments.contact_stress[1];
    // The piston takes kinetic stress half a step before, without the strain of the height.
    EXPECT_NEAR(box.stress_yy(), contact + kinetic, 0.1 * kinetic + 1e-9 * contact);
    EXPECT_GT(contact, 0.0);
  }
}

}  // namespace
}  // namespace grainlaw::dem
