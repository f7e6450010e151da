#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <string>

#include "dem/local_data.h"

namespace grainlaw::testing {

/// A steady box of simple shear with known stress and density, in units rho_p = d = k_n = 1. Each
/// frame adds Gaussian noise, new in every frame, to shear stress and volume fraction.
struct SyntheticBox {
  std::string name = "box";
  double inertial_number = 0.1;
  double softness = 0.01;
  double bond_number = 0.0;
  double friction = 0.4;
  double volume_fraction = 0.6;
  double friction_noise = 0.0;  ///< of a frame, relative
  double fraction_noise = 0.0;
  double correlation = 0.0;      ///< of the two
  double slope_deviation = 0.0;  ///< of the velocity, relative, of alternating sign
  int frames = 64;
  std::uint64_t seed = 1;
};

inline constexpr double box_height = 13.0;

inline dem::ChuteConditions conditions_of(const SyntheticBox& box) {
  dem::ChuteConditions conditions;
  conditions.geometry = "simple_shear";
  conditions.grain_density = 1.0;
  conditions.stiffness = 1.0;
  conditions.attraction = box.bond_number * box.softness;
  conditions.shear_rate = box.inertial_number * std::sqrt(box.softness);
  return conditions;
}

/// Averages of a frame as coarse graining wants them; the box is one bin.
inline dem::BinMoments moments(const SyntheticBox& box,
                               double friction,
                               double fraction,
                               double slope_deviation) {
  dem::BinMoments bin;
  bin.mass = fraction;
  bin.mass_offset_squared = fraction * box_height * box_height / 12.0;
  bin.momentum_offset[0] =
      slope_deviation * conditions_of(box).shear_rate * bin.mass_offset_squared;
  bin.contact_stress[1] = box.softness;              // sigma_yy
  bin.contact_stress[3] = -friction * box.softness;  // sigma_xy
  bin.grains = bin.contacts = bin.contact_points = 1.0;
  return bin;
}

inline dem::LocalData local_data(const SyntheticBox& box) {
  std::mt19937_64 random(box.seed);
  std::normal_distribution<double> normal;
  dem::LocalData data;
  data.name = box.name;
  data.conditions = conditions_of(box);
  data.frames = {.bin_width = box_height, .frames = {}, .periodic = true};
  for (int k = 0; k < box.frames; ++k) {
    const double one = normal(random);
    const double other =
        box.correlation * one + std::sqrt(1.0 - box.correlation * box.correlation) * normal(random);
    dem::ProfileFrame frame{
        .begin = static_cast<double>(k), .end = k + 1.0, .samples = 1, .bins = {}};
    frame.bins = {moments(box,
                          box.friction * (1.0 + box.friction_noise * one),
                          box.volume_fraction * (1.0 + box.fraction_noise * other),
                          k % 2 == 0 ? box.slope_deviation : -box.slope_deviation)};
    data.frames.frames.push_back(frame);
  }
  data.window = {true, 0.0, static_cast<double>(box.frames), ""};
  data.rows = dem::average(data.frames, data.conditions, data.window);
  data.summary.wall_seconds = 10.0;
  data.summary.startup_wall_seconds = 2.0;
  return data;
}

}  // namespace grainlaw::testing
