#include "dem/local_data.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "dem/statistics.h"

namespace grainlaw::dem {
namespace {

using Moments = std::vector<BinMoments>;

/// The fields of one bin.
enum Field {
  velocity,
  shear_rate,
  volume_fraction,
  shear_stress,
  normal_stress,
  temperature,
  inertial_number,
  softness,
  friction,
  fields
};
using Fields = std::array<double, fields>;

std::span<const ProfileFrame> frames_inside(const ProfileFrames& frames,
                                            const SteadyWindow& window) {
  const double rounding = 1e-9 * std::max(1.0, std::abs(window.end));
  const auto begins = [&](const ProfileFrame& f) { return f.begin >= window.begin - rounding; };
  const auto ends = [&](const ProfileFrame& f) { return f.end > window.end + rounding; };
  const auto first = std::find_if(frames.frames.begin(), frames.frames.end(), begins);
  const auto last = std::find_if(first, frames.frames.end(), ends);
  return {first, last};
}

Moments mean_moments(std::span<const ProfileFrame> frames) {
  Moments mean(frames.empty() ? 0 : frames.front().bins.size());
  double samples = 0.0;
  for (const ProfileFrame& frame : frames) samples += frame.samples;
  for (const ProfileFrame& frame : frames) {
    for (std::size_t k = 0; k < mean.size(); ++k) {
      add_scaled(mean[k], frame.bins[k], frame.samples / samples);
    }
  }
  return mean;
}

/// Mean velocity of a bin and the height it belongs to: that of the centre of mass in the bin.
struct VelocityPoint {
  double z;
  double velocity;
};

VelocityPoint velocity_point(const Moments& moments, std::size_t k, double bin_width) {
  const BinMoments& bin = moments[k];
  return {static_cast<double>(k) * bin_width + bin.mass_offset / bin.mass,
          bin.momentum[0] / bin.mass};
}

/// Central difference over the neighbouring bins, one-sided at the ends of the layer.
double slope(const Moments& moments, std::size_t k, double bin_width) {
  const auto filled = [&](std::size_t j) { return j < moments.size() && moments[j].mass > 0.0; };
  const std::size_t below = k > 0 && filled(k - 1) ? k - 1 : k;
  const std::size_t above = filled(k + 1) ? k + 1 : k;
  if (below == above) return std::nan("");
  const VelocityPoint low = velocity_point(moments, below, bin_width);
  const VelocityPoint high = velocity_point(moments, above, bin_width);
  return (high.velocity - low.velocity) / (high.z - low.z);
}

double velocity_at_centre(const Moments& moments, std::size_t k, double bin_width) {
  const BinMoments& bin = moments[k];
  const double gradient = slope(moments, k, bin_width);
  const double mean = bin.momentum[0] / bin.mass;
  return std::isnan(gradient) ? mean : mean - gradient * bin.mass_offset / bin.mass;
}

/// Mean square of the fluctuation of v_x about the straight line through the bin: about the mean
/// alone it would hold the spurious part (gd w)^2 / 12.
double variance_about_line(const BinMoments& bin) {
  const double mean = bin.momentum[0] / bin.mass;
  const double offset = bin.mass_offset / bin.mass;
  const double offset_variance = bin.mass_offset_squared / bin.mass - offset * offset;
  const double covariance = bin.momentum_offset / bin.mass - offset * mean;
  const double explained = offset_variance > 0.0 ? covariance * covariance / offset_variance : 0.0;
  return bin.momentum_flux[0] / bin.mass - mean * mean - explained;
}

double kinetic_stress(const BinMoments& bin, std::size_t component, std::size_t a, std::size_t b) {
  return bin.momentum_flux[component] - bin.momentum[a] * bin.momentum[b] / bin.mass;
}

/// Components of stress in the order xx yy zz xy xz yz, and of the gradient.
struct Components {
  std::size_t normal, shear, gradient;
};
Components components(const ChuteConditions& conditions) {
  const bool box = conditions.geometry == "simple_shear" || conditions.geometry == "body_force_box";
  return box ? Components{1, 3, 1} : Components{2, 4, 2};
}

Fields fields_of(const Moments& moments,
                 std::size_t k,
                 double bin_width,
                 const ChuteConditions& c) {
  const BinMoments& bin = moments[k];
  const Components at = components(c);
  Fields f{};
  f[velocity] = velocity_at_centre(moments, k, bin_width);
  f[shear_rate] = c.shear_rate != 0.0 ? c.shear_rate : slope(moments, k, bin_width);
  f[volume_fraction] = bin.mass / c.grain_density;
  f[shear_stress] = -(bin.contact_stress[at.shear] + kinetic_stress(bin, at.shear, 0, at.gradient));
  f[normal_stress] =
      bin.contact_stress[at.normal] + kinetic_stress(bin, at.normal, at.gradient, at.gradient);
  f[temperature] = (variance_about_line(bin) + kinetic_stress(bin, 1, 1, 1) / bin.mass +
                    kinetic_stress(bin, 2, 2, 2) / bin.mass) /
                   3.0;
  f[inertial_number] =
      f[shear_rate] * c.grain_diameter * std::sqrt(c.grain_density / f[normal_stress]);
  f[softness] = f[normal_stress] * c.grain_diameter / c.stiffness;
  f[friction] = f[shear_stress] / f[normal_stress];
  return f;
}

/// What each frame adds to the fields of a bin, to first order in its distance from the mean: a
/// series whose mean is the field and whose scatter gives its error, for ratios and slopes alike.
std::array<std::vector<double>, fields> linearised(std::span<const ProfileFrame> frames,
                                                   const Moments& mean,
                                                   std::size_t k,
                                                   double bin_width,
                                                   const ChuteConditions& conditions) {
  constexpr double epsilon = 1e-5;
  const Fields centre = fields_of(mean, k, bin_width, conditions);
  std::array<std::vector<double>, fields> series;
  Moments varied = mean;
  const std::size_t first = k > 0 ? k - 1 : k;
  const std::size_t last = std::min(k + 1, mean.size() - 1);
  for (const ProfileFrame& frame : frames) {
    for (std::size_t j = first; j <= last; ++j) {
      varied[j] = {};
      add_scaled(varied[j], mean[j], 1.0 - epsilon);
      add_scaled(varied[j], frame.bins[j], epsilon);
    }
    const Fields f = fields_of(varied, k, bin_width, conditions);
    for (std::size_t i = 0; i < fields; ++i) {
      series[i].push_back(centre[i] + (f[i] - centre[i]) / epsilon);
    }
  }
  return series;
}

LocalRow make_row(std::span<const ProfileFrame> frames,
                  const Moments& mean,
                  std::size_t k,
                  double bin_width,
                  const ChuteConditions& conditions) {
  const Fields centre = fields_of(mean, k, bin_width, conditions);
  const auto series = linearised(frames, mean, k, bin_width, conditions);
  const auto estimate = [&](Field field) {
    const BlockAverage average = block_average(series[field]);
    return Estimate{centre[field], average.error, average.effective_samples};
  };
  LocalRow row;
  row.velocity = estimate(velocity);
  row.shear_rate = estimate(shear_rate);
  row.volume_fraction = estimate(volume_fraction);
  row.shear_stress = estimate(shear_stress);
  row.normal_stress = estimate(normal_stress);
  row.temperature = estimate(temperature);
  row.inertial_number = estimate(inertial_number);
  row.softness = estimate(softness);
  row.friction = estimate(friction);
  row.effective_samples = row.velocity.effective_samples;
  return row;
}

/// Mass per area above the centre of bin k, the density in the bin taken as linear. What is below
/// is subtracted from the whole, so that grains above all bins count.
double mass_above(const Moments& mean, std::size_t k, double bin_width, double total) {
  double below = 0.0;
  for (std::size_t j = 0; j < k; ++j) below += mean[j].mass * bin_width;
  // No more than a density that falls to zero at one face: the surface is steeper than a line.
  const double steepest = mean[k].mass * bin_width / 6.0;
  const double offset = std::clamp(mean[k].mass_offset, -steepest, steepest);
  const double lower_half = 0.5 * mean[k].mass * bin_width - 1.5 * offset;
  return total - below - lower_half;
}

/// Bins that are never, or hardly ever, visited carry no field.
bool counts(const BinMoments& bin, const ChuteConditions& conditions) {
  constexpr double least_fraction = 0.01;
  return bin.mass > least_fraction * conditions.grain_density;
}

}  // namespace

Convergence worst_convergence(const std::vector<LocalRow>& rows, Estimate LocalRow::*field) {
  Convergence worst = rows.empty() ? Convergence::not_converged : Convergence::converged;
  for (const LocalRow& row : rows) {
    worst = std::min(worst, convergence((row.*field).effective_samples));
  }
  return worst;
}

std::vector<LocalRow> average(const ProfileFrames& frames,
                              const ChuteConditions& conditions,
                              const SteadyWindow& window) {
  const auto inside = frames_inside(frames, window);
  const Moments mean = mean_moments(inside);
  std::vector<LocalRow> rows;
  for (std::size_t k = 0; k < mean.size(); ++k) {
    if (!counts(mean[k], conditions)) continue;
    LocalRow row = make_row(inside, mean, k, frames.bin_width, conditions);
    row.z = frames.bin_centre(k);
    row.mass_above = mass_above(mean, k, frames.bin_width, conditions.mass_per_area);
    rows.push_back(row);
  }
  return rows;
}

std::vector<std::vector<double>> block_velocities(const LocalData& data) {
  const auto inside = frames_inside(data.frames, data.window);
  if (inside.empty()) return {};
  std::vector<double> series;
  for (const ProfileFrame& frame : inside) series.push_back(mean_velocity(frame));
  const std::size_t longest = std::max<std::size_t>(1, inside.size() / 4);
  const std::size_t length = std::min(block_average(series).block_length, longest);
  std::vector<std::vector<double>> blocks;
  for (std::size_t begin = 0; begin + length <= inside.size(); begin += length) {
    const Moments mean = mean_moments(inside.subspan(begin, length));
    std::vector<double>& block = blocks.emplace_back();
    for (const LocalRow& row : data.rows) {
      const double bin = (row.z - data.frames.z_begin) / data.frames.bin_width;
      block.push_back(
          velocity_at_centre(mean, static_cast<std::size_t>(bin), data.frames.bin_width));
    }
  }
  return blocks;
}

}  // namespace grainlaw::dem
