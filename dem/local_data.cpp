#include "dem/local_data.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "dem/statistics.h"
#include "dem/time_scales.h"

namespace grainlaw::dem {
namespace {

constexpr std::size_t field_numbers = sizeof(FieldRow) / sizeof(double);
using FieldNumbers = std::array<double, field_numbers>;
using FieldRows = std::vector<FieldRow>;

/// The mean moved a little towards one frame.
FrameMoments moved(const FrameMoments& mean, const ProfileFrame& frame, double epsilon) {
  FrameMoments result = mean;
  const auto move = [&](auto& to, const auto& from, const auto& towards) {
    for (std::size_t k = 0; k < to.size(); ++k) {
      to[k] = {};
      add_scaled(to[k], from[k], 1.0 - epsilon);
      add_scaled(to[k], towards[k], epsilon);
    }
  };
  move(result.bins, mean.bins, frame.bins);
  move(result.sliding, mean.sliding, frame.sliding);
  return result;
}

/// Fields of a window and what each frame adds to them, to first order in its distance from the
/// mean: series whose means are the fields and whose scatter gives their errors, for ratios and
/// slopes alike.
struct FieldSeries {
  FieldRows mean;
  std::vector<FieldRows> frames;  ///< [frame][row]

  std::vector<double> series(std::size_t row, std::size_t number) const {
    std::vector<double> result;
    result.reserve(frames.size());
    for (const FieldRows& rows : frames) {
      result.push_back(std::bit_cast<FieldNumbers>(rows[row])[number]);
    }
    return result;
  }
};

FieldRow extrapolated(const FieldRow& centre, const FieldRow& near, double epsilon) {
  const auto from = std::bit_cast<FieldNumbers>(centre);
  auto to = std::bit_cast<FieldNumbers>(near);
  for (std::size_t k = 0; k < field_numbers; ++k) to[k] = from[k] + (to[k] - from[k]) / epsilon;
  return std::bit_cast<FieldRow>(to);
}

FieldSeries linearised(std::span<const ProfileFrame> frames,
                       const ProfileFrames& grid,
                       const Kernel& kernel,
                       const ChuteConditions& conditions) {
  constexpr double epsilon = 1e-5;
  const FrameMoments mean = mean_moments(frames);
  FieldSeries series{.mean = coarse_grain(mean, grid, kernel, conditions), .frames = {}};
  for (const ProfileFrame& frame : frames) {
    FieldRows& rows = series.frames.emplace_back(
        coarse_grain(moved(mean, frame, epsilon), grid, kernel, conditions));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      rows[k] = extrapolated(series.mean[k], rows[k], epsilon);
    }
  }
  return series;
}

/// Where a field stands in a FieldRow.
std::size_t index_of(double FieldRow::*field) {
  static const FieldRow row;
  return static_cast<std::size_t>(&(row.*field) - reinterpret_cast<const double*>(&row));
}

struct Factor {
  double FieldRow::*field;
  double power;
};

/// A product of powers of fields, with what they scatter together.
Estimate product(const FieldSeries& series,
                 std::size_t k,
                 double value,
                 std::initializer_list<Factor> factors) {
  std::vector<double> products(series.frames.size(), value);
  for (const auto& [field, power] : factors) {
    const std::vector<double> values = series.series(k, index_of(field));
    const double scale = value * power / (series.mean[k].*field);
    for (std::size_t f = 0; f < values.size(); ++f) {
      products[f] += scale * (values[f] - series.mean[k].*field);
    }
  }
  const BlockAverage average = block_average(products);
  return {value, average.error, average.effective_samples};
}

void add_numbers(const FieldSeries& series,
                 std::size_t k,
                 const ChuteConditions& grains,
                 LocalRow& row) {
  constexpr Factor pressure{&FieldRow::normal_stress, -1.0};
  const DimensionlessNumbers numbers = dimensionless_numbers(grains, row);
  if (grains.attraction > 0.0) {
    row.bond_number = product(series, k, numbers.bond_number, {pressure});
  }
  row.scaled_temperature =
      product(series, k, numbers.temperature, {{&FieldRow::temperature, 1.0}, pressure});
  const double bulk =
      row.inertial_number.value * conversion(InertialNumber::shear_bulk, row.volume_fraction.value);
  row.bulk_inertial_number = product(
      series, k, bulk, {{&FieldRow::inertial_number, 1.0}, {&FieldRow::volume_fraction, 0.5}});
}

LocalRow make_row(const FieldSeries& series, std::size_t k, const ChuteConditions& grains) {
  const auto estimate = [&](double FieldRow::*field) {
    const BlockAverage average = block_average(series.series(k, index_of(field)));
    return Estimate{series.mean[k].*field, average.error, average.effective_samples};
  };
  LocalRow row;
  row.mass_above = series.mean[k].mass_above;
  row.velocity = estimate(&FieldRow::velocity);
  row.shear_rate = estimate(&FieldRow::shear_rate);
  row.volume_fraction = estimate(&FieldRow::volume_fraction);
  row.shear_stress = estimate(&FieldRow::shear_stress);
  row.normal_stress = estimate(&FieldRow::normal_stress);
  row.pressure = estimate(&FieldRow::pressure);
  row.temperature = estimate(&FieldRow::temperature);
  row.inertial_number = estimate(&FieldRow::inertial_number);
  row.softness = estimate(&FieldRow::softness);
  row.friction = estimate(&FieldRow::friction);
  row.coordination = estimate(&FieldRow::coordination);
  row.dissipation = estimate(&FieldRow::dissipation);
  row.sliding_share = estimate(&FieldRow::sliding_share);
  row.effective_samples = row.velocity.effective_samples;
  add_numbers(series, k, grains, row);
  return row;
}

/// Rows that are never, or hardly ever, visited carry no field.
bool counts(const FrameMoments& mean,
            const ProfileFrames& grid,
            std::size_t row,
            const ChuteConditions& conditions) {
  constexpr double least_fraction = 0.01;
  double density = 0.0;
  for (std::size_t q = 0; q < grid.bins_per_row; ++q) {
    density += mean.bins[row * grid.bins_per_row + q].mass;
  }
  return density >
         least_fraction * conditions.grain_density * static_cast<double>(grid.bins_per_row);
}

FieldRow errors_of(const FieldSeries& series, std::size_t k) {
  FieldNumbers errors{};
  for (std::size_t i = 0; i < field_numbers; ++i) {
    errors[i] = block_average(series.series(k, i)).error;
  }
  return std::bit_cast<FieldRow>(errors);
}

WidthFields fields_at(std::span<const ProfileFrame> frames,
                      const ProfileFrames& grid,
                      const Kernel& kernel,
                      const ChuteConditions& conditions) {
  const FieldSeries series = linearised(frames, grid, kernel, conditions);
  const auto margin = static_cast<double>(margin_rows(grid, kernel));
  WidthFields fields{.width = kernel.width,
                     .z_begin = grid.z_begin - margin * grid.row_width(),
                     .row_width = grid.row_width(),
                     .values = series.mean,
                     .errors = {}};
  for (std::size_t k = 0; k < series.mean.size(); ++k) {
    fields.errors.push_back(errors_of(series, k));
  }
  return fields;
}

}  // namespace

TimeScales time_scales(const ChuteConditions& conditions, const LocalRow& row) {
  return time_scales({.grain_density = conditions.grain_density,
                      .diameter = conditions.grain_diameter,
                      .stiffness = conditions.stiffness,
                      .attraction = conditions.attraction,
                      .gravity = conditions.gravity,
                      .shear_rate = row.shear_rate.value,
                      .pressure = row.normal_stress.value,
                      .temperature = row.temperature.value});
}

DimensionlessNumbers dimensionless_numbers(const ChuteConditions& conditions, const LocalRow& row) {
  return dimensionless_numbers(time_scales(conditions, row));
}

std::span<const ProfileFrame> frames_inside(const ProfileFrames& frames,
                                            const SteadyWindow& window) {
  const double rounding = 1e-9 * std::max(1.0, std::abs(window.end));
  const auto begins = [&](const ProfileFrame& f) { return f.begin >= window.begin - rounding; };
  const auto ends = [&](const ProfileFrame& f) { return f.end > window.end + rounding; };
  const auto first = std::find_if(frames.frames.begin(), frames.frames.end(), begins);
  const auto last = std::find_if(first, frames.frames.end(), ends);
  return {first, last};
}

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
  if (inside.empty()) return {};
  const FrameMoments mean = mean_moments(inside);
  const FieldSeries series = linearised(inside, frames, frames.kernel, conditions);
  const std::size_t margin = margin_rows(frames, frames.kernel);
  std::vector<LocalRow> rows;
  for (std::size_t k = 0; (k + 1) * frames.bins_per_row <= mean.bins.size(); ++k) {
    if (!counts(mean, frames, k, conditions)) continue;
    rows.push_back(make_row(series, k + margin, conditions));
    rows.back().z = frames.row_centre(k);
  }
  return rows;
}

std::vector<WidthFields> fields_at_widths(const ProfileFrames& frames,
                                          const ChuteConditions& conditions,
                                          const SteadyWindow& window) {
  const auto inside = frames_inside(frames, window);
  if (inside.empty()) return {};
  std::vector<WidthFields> result;
  for (const double factor : {0.5, 1.0, 2.0}) {
    const Kernel kernel{frames.kernel.shape, factor * frames.kernel.width};
    if (kernel.width == 0.0 && factor != 1.0) continue;
    result.push_back(fields_at(inside, frames, kernel, conditions));
  }
  return result;
}

std::vector<std::vector<double>> block_velocities(const LocalData& data) {
  const ProfileFrames& frames = data.frames;
  const auto inside = frames_inside(frames, data.window);
  if (inside.empty()) return {};
  std::vector<double> series;
  for (const ProfileFrame& frame : inside) series.push_back(mean_velocity(frame));
  const std::size_t longest = std::max<std::size_t>(1, inside.size() / 4);
  const std::size_t length = std::min(block_average(series).block_length, longest);
  const std::size_t margin = margin_rows(frames, frames.kernel);
  std::vector<std::vector<double>> blocks;
  for (std::size_t begin = 0; begin + length <= inside.size(); begin += length) {
    const FieldRows fields = coarse_grain(
        mean_moments(inside.subspan(begin, length)), frames, frames.kernel, data.conditions);
    std::vector<double>& block = blocks.emplace_back();
    for (const LocalRow& row : data.rows) {
      const double k = (row.z - frames.z_begin) / frames.row_width();
      block.push_back(fields[static_cast<std::size_t>(k) + margin].velocity);
    }
  }
  return blocks;
}

}  // namespace grainlaw::dem
