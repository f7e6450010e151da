#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "continuum/bagnold_profile.h"
#include "dem/local_data.h"

namespace grainlaw::testing {

/// A steady chute whose law is known: uniform density above the base top, some grains in the
/// pockets below it, tau = tau_c + a gd^2 + b gd, u = 0 at the no-slip height. Grain units, m = d =
/// g = 1.
///
/// Noise: each frame adds to the velocity a sum of smooth modes over the whole depth with random
/// amplitudes, new in every frame, so neighbouring rows are almost fully correlated and the shear
/// rates move with the velocities, as in real flow. Likewise for the shear stress.
struct SyntheticChute {
  std::string name = "synthetic";
  double inclination = 23.0 * std::numbers::pi / 180.0;
  double a = 26.0;
  double b = 0.0;
  double tau_c = 0.0;
  double no_slip_height = 1.1;
  double volume_fraction = 0.58;
  int height = 40;              ///< of the free surface, whole bins
  double velocity_noise = 0.0;  ///< rms of the lowest mode in one frame [velocity]
  double stress_noise = 0.0;    ///< relative, likewise
  int frames = 60;
  std::uint64_t seed = 1;
};

inline constexpr double pocket_fraction = 0.2;  ///< phi of the bin below z = 0
inline constexpr double grain_density = 6.0 / std::numbers::pi;

/// a of a mu(I) material that flows with I at this tilt (continuum/rheology.h, GeneralisedBagnold).
inline double bagnold_coefficient(double inertial_number, double inclination) {
  return grain_density * std::tan(inclination) / (inertial_number * inertial_number);
}

inline dem::ChuteConditions conditions_of(const SyntheticChute& chute) {
  dem::ChuteConditions conditions;
  conditions.inclination = chute.inclination;
  conditions.grain_density = grain_density;
  conditions.stiffness = 2e5;
  conditions.contact_friction = 0.5;
  conditions.mass_per_area =
      grain_density * (chute.volume_fraction * chute.height + pocket_fraction);
  conditions.base = "synthetic bumpy base";
  return conditions;
}

inline dem::LocalRow exact_row(const SyntheticChute& chute, double z) {
  const double density = grain_density * (z < 0.0 ? pocket_fraction : chute.volume_fraction);
  const double drive = std::sin(chute.inclination);
  const double bulk = grain_density * chute.volume_fraction;
  dem::LocalRow row;
  row.z = z;
  row.mass_above = z < 0.0 ? bulk * chute.height - density * z : bulk * (chute.height - z);
  const double tau = drive * row.mass_above;
  const bool moves = z > chute.no_slip_height;
  const double u = continuum::bagnold_velocity(chute.a,
                                               chute.b,
                                               chute.tau_c,
                                               bulk * drive,
                                               chute.height - chute.no_slip_height,
                                               chute.height - z);
  row.velocity = {moves ? u : 0.0, 0.0};
  row.shear_rate = {
      moves ? continuum::bagnold_shear_rate(chute.a, chute.b, tau - chute.tau_c) : 0.0, 0.0};
  row.volume_fraction = {density / grain_density, 0.0};
  row.shear_stress = {tau, 0.0};
  row.normal_stress = {tau / std::tan(chute.inclination), 0.0};
  return row;
}

/// Sum of modes cos(k pi z / H) with random amplitudes, and its derivative.
class RandomModes {
 public:
  RandomModes(double rms, double height, std::mt19937_64& random) : height_(height) {
    std::normal_distribution<double> normal;
    for (int k = 0; k < 6; ++k) amplitudes_.push_back(rms * normal(random) / (1.0 + k));
  }
  double value(double z) const { return sum(z, false); }
  double slope(double z) const { return sum(z, true); }

 private:
  double sum(double z, bool derivative) const {
    double total = 0.0;
    for (std::size_t k = 0; k < amplitudes_.size(); ++k) {
      const double wave = static_cast<double>(k) * std::numbers::pi / height_;
      total += amplitudes_[k] * (derivative ? -wave * std::sin(wave * z) : std::cos(wave * z));
    }
    return total;
  }
  double height_;
  std::vector<double> amplitudes_;
};

inline dem::BinMoments moments_of(const dem::LocalRow& row) {
  dem::BinMoments bin;
  bin.mass = grain_density * row.volume_fraction.value;
  bin.momentum[0] = bin.mass * row.velocity.value;
  bin.momentum_flux[0] = bin.mass * row.velocity.value * row.velocity.value;
  bin.mass_offset_squared = bin.mass / 12.0;  // uniform in a bin of width 1
  bin.momentum_offset[0] = row.shear_rate.value * bin.mass_offset_squared;
  bin.contact_stress[2] = row.normal_stress.value;
  bin.contact_stress[4] = -row.shear_stress.value;  // a flux of momentum against the gradient
  return bin;
}

/// Mean and standard error over frames that are independent of each other.
inline dem::Estimate mean_over_frames(const std::vector<std::vector<dem::LocalRow>>& frames,
                                      std::size_t k,
                                      dem::Estimate dem::LocalRow::*field) {
  const double n = static_cast<double>(frames.size());
  double mean = 0.0, squares = 0.0;
  for (const auto& rows : frames) mean += (rows[k].*field).value / n;
  for (const auto& rows : frames) squares += std::pow((rows[k].*field).value - mean, 2);
  return {mean, std::sqrt(squares / (n * (n - 1.0)))};
}

inline void complete(dem::LocalRow& row, const dem::ChuteConditions& conditions) {
  row.temperature = {0.0, 0.0};
  row.friction = {row.shear_stress.value / row.normal_stress.value,
                  row.shear_stress.error / row.normal_stress.value};
  const double rate_to_I = std::sqrt(grain_density / row.normal_stress.value);
  row.inertial_number = {row.shear_rate.value * rate_to_I, row.shear_rate.error * rate_to_I};
  row.softness = {row.normal_stress.value / conditions.stiffness, 0.0};
}

/// The local data such a chute would give. Without noise every row is exact.
inline dem::LocalData local_data(const SyntheticChute& chute) {
  dem::LocalData data;
  data.name = chute.name;
  data.conditions = conditions_of(chute);
  data.window = {true, 0.0, 2.0 * chute.frames, "synthetic"};
  data.frames.z_begin = -1.0;
  std::mt19937_64 random(chute.seed);
  std::vector<std::vector<dem::LocalRow>> frames;
  for (int f = 0; f < chute.frames; ++f) {
    const RandomModes velocity(chute.velocity_noise, chute.height, random);
    const RandomModes stress(chute.stress_noise, chute.height, random);
    dem::ProfileFrame frame;
    frame.begin = 2.0 * f;
    frame.end = 2.0 * (f + 1);
    frame.samples = 20;
    frames.emplace_back();
    for (int k = -1; k < chute.height; ++k) {
      dem::LocalRow row = exact_row(chute, k + 0.5);
      row.velocity.value += velocity.value(row.z);
      row.shear_rate.value += velocity.slope(row.z);
      row.shear_stress.value *= 1.0 + stress.value(row.z);
      frames.back().push_back(row);
      frame.bins.push_back(moments_of(row));
    }
    data.frames.frames.push_back(frame);
  }
  for (int k = -1; k < chute.height; ++k) {
    const auto bin = static_cast<std::size_t>(k + 1);
    dem::LocalRow row = exact_row(chute, k + 0.5);
    if (chute.velocity_noise > 0.0 || chute.stress_noise > 0.0) {
      row.velocity = mean_over_frames(frames, bin, &dem::LocalRow::velocity);
      row.shear_rate = mean_over_frames(frames, bin, &dem::LocalRow::shear_rate);
      row.shear_stress = mean_over_frames(frames, bin, &dem::LocalRow::shear_stress);
    }
    complete(row, data.conditions);
    data.rows.push_back(row);
  }
  return data;
}

}  // namespace grainlaw::testing
