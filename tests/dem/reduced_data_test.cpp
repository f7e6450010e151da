#include "dem/reduced_data.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace grainlaw::dem {
namespace {

constexpr double single = 6e-8;  // rounding of one number

/// A layer that flows with v = 2 z, its frames of the steady window noisy.
LocalData layer(std::size_t frames, std::size_t rows, const std::string& geometry = "chute") {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  LocalData data;
  data.name = "layer";
  data.conditions.geometry = geometry;
  data.conditions.grain_density = 1.0;
  data.conditions.stiffness = 1e4;
  data.conditions.mass_per_area = 0.6 * static_cast<double>(rows);
  data.frames.z_begin = geometry == "chute" ? 0.0 : 5.0;
  data.frames.bin_width = 0.25;
  data.frames.bins_per_row = 4;
  data.frames.kernel = {KernelShape::lucy, 1.0};
  for (std::size_t f = 0; f < frames; ++f) {
    const auto time = static_cast<double>(f);
    ProfileFrame& frame = data.frames.frames.emplace_back(
        ProfileFrame{.begin = time, .end = time + 1.0, .samples = 10, .bins = {}});
    for (std::size_t k = 0; k < 4 * rows; ++k) {
      const double v = 2.0 * (0.125 + 0.25 * static_cast<double>(k)) + 0.01 * noise(random);
      BinMoments bin;
      bin.mass = 0.6;
      bin.momentum[0] = 0.6 * v;
      bin.momentum_flux[0] = 0.6 * v * v;
      bin.mass_offset = 0.01;
      bin.mass_offset_squared = 0.6 * 0.25 * 0.25 / 12.0;
      bin.momentum_offset[0] = 2.0 * bin.mass_offset_squared + v * bin.mass_offset;
      bin.contact_stress[2] = 10.0 + noise(random);
      frame.bins.push_back(bin);
    }
  }
  data.window = {true, 0.25 * static_cast<double>(frames), static_cast<double>(frames), "steady"};
  data.rows = average(data.frames, data.conditions, data.window);
  return data;
}

/// Mass of a wedge of unit angle, or of a column, over the whole run.
double mass_times_time(const LocalData& data) {
  const bool radial = data.conditions.geometry == "split_bottom";
  double sum = 0.0;
  for (const ProfileFrame& frame : data.frames.frames) {
    for (std::size_t k = 0; k < frame.bins.size(); ++k) {
      sum += frame.bins[k].mass * data.frames.bin_width * (frame.end - frame.begin) *
             (radial ? data.frames.bin_centre(k) : 1.0);
    }
  }
  return sum;
}

TEST(ReducedData, FramesAreJoinedInsideTheWindowAndBeforeIt) {
  const LocalData whole = layer(400, 40);
  const LocalData small = reduced(whole);
  EXPECT_EQ(frames_inside(small.frames, small.window).size(), 32u);
  EXPECT_EQ(small.frames.frames.size(), 64u);
  EXPECT_EQ(small.frames.frames.front().begin, 0.0);
  EXPECT_EQ(small.frames.frames[32].begin, whole.window.begin);
  EXPECT_EQ(small.frames.frames.back().end, whole.window.end);
  EXPECT_EQ(small.frames.bins_per_row, 2u);
  EXPECT_EQ(small.frames.bin_width, 0.5);
}

TEST(ReducedData, ReducingOnceMoreChangesNothing) {
  const LocalData once = reduced(layer(400, 40));
  const LocalData twice = reduced(once);
  ASSERT_EQ(twice.frames.frames.size(), once.frames.frames.size());
  EXPECT_EQ(twice.frames.bins_per_row, once.frames.bins_per_row);
  EXPECT_EQ(twice.frames.frames[40].bins[7].momentum[0],
            once.frames.frames[40].bins[7].momentum[0]);
}

TEST(ReducedData, NoMassIsLostInALayerOrARing) {
  for (const std::string geometry : {"chute", "split_bottom"}) {
    const LocalData whole = layer(100, 40, geometry);
    EXPECT_NEAR(
        mass_times_time(reduced(whole)), mass_times_time(whole), single * mass_times_time(whole))
        << geometry;
  }
}

TEST(ReducedData, RowsAveragedAnewAreThoseOfTheWholeRun) {
  const LocalData whole = layer(400, 12);
  LocalData small = reduced(whole);
  for (std::size_t k = 0; k < small.rows.size(); ++k) {
    EXPECT_EQ(small.rows[k].velocity.value, whole.rows[k].velocity.value);  // kept
  }
  small.rows = average(small.frames, small.conditions, small.window);
  ASSERT_EQ(small.rows.size(), whole.rows.size());
  // Noise of a bin of 300 frames, 0.01 / sqrt(300), and of half as many places in the kernel.
  const double noise = 0.01 / std::sqrt(300.0);
  for (std::size_t k = 0; k < small.rows.size(); ++k) {
    EXPECT_NEAR(small.rows[k].velocity.value, whole.rows[k].velocity.value, 4.0 * noise);
    EXPECT_NEAR(small.rows[k].shear_rate.value, 2.0, 8.0 * noise) << k;
    EXPECT_NEAR(small.rows[k].volume_fraction.value, 0.6, k < 2 || k > 9 ? 0.6 : 0.02);
  }
}

TEST(ReducedData, BlocksForCovariancesAreStillThere) {
  const LocalData small = reduced(layer(400, 40));
  const auto blocks = block_velocities(small);
  EXPECT_GE(blocks.size(), 4u);
  // Independent frames: 32 of them make six blocks of five (Lee et al. 2011).
  EXPECT_EQ(blocks.front().size(), small.rows.size());
}

TEST(ReducedData, ABoxOfOneBinKeepsItsFrames) {
  LocalData box = layer(400, 1, "simple_shear");
  for (ProfileFrame& frame : box.frames.frames) frame.bins.resize(1);
  box.frames.bins_per_row = 1;
  box.frames.kernel = {};
  box.frames.periodic = true;
  EXPECT_EQ(reduced(box).frames.frames.size(), 400u);
}

}  // namespace
}  // namespace grainlaw::dem
