#include "dem/ring_grid.h"

#include <bit>
#include <cmath>
#include <limits>

#include "dem/local_data.h"
#include "dem/statistics.h"

namespace grainlaw::dem {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t field_numbers = sizeof(RingField) / sizeof(double);
using FieldNumbers = std::array<double, field_numbers>;

/// Velocity about the centre of a cell: value + slope_r o_r + slope_z o_z.
struct VelocityPlane {
  std::array<double, 3> value{};
  std::array<double, 3> slope_r{};
  std::array<double, 3> slope_z{};
};

/// Positions of grains about their mean.
struct Spread {
  double r, z;         ///< mean offsets
  double rr, zz, rz;   ///< covariances
  double determinant;  ///< 0: they lie on a line
};

Spread spread(const CellMoments& cell) {
  Spread s{};
  s.r = cell.mass_offset[0] / cell.mass;
  s.z = cell.mass_offset[1] / cell.mass;
  s.rr = cell.mass_offset_square[0] / cell.mass - s.r * s.r;
  s.zz = cell.mass_offset_square[1] / cell.mass - s.z * s.z;
  s.rz = cell.mass_offset_square[2] / cell.mass - s.r * s.z;
  constexpr double least = 1e-10;  // of what the variances allow: rounding below
  const double determinant = s.rr * s.zz - s.rz * s.rz;
  s.determinant = determinant > least * s.rr * s.zz ? determinant : 0.0;
  return s;
}

VelocityPlane velocity_plane(const CellMoments& cell) {
  const Spread s = spread(cell);
  VelocityPlane plane;
  for (std::size_t a = 0; a < 3; ++a) {
    const double mean = cell.momentum[a] / cell.mass;
    const double with_r = cell.momentum_offset_r[a] / cell.mass - s.r * mean;
    const double with_z = cell.momentum_offset_z[a] / cell.mass - s.z * mean;
    if (s.determinant > 0.0) {
      plane.slope_r[a] = (s.zz * with_r - s.rz * with_z) / s.determinant;
      plane.slope_z[a] = (s.rr * with_z - s.rz * with_r) / s.determinant;
    }
    plane.value[a] = mean - plane.slope_r[a] * s.r - plane.slope_z[a] * s.z;
  }
  return plane;
}

/// sum m v' v', v' = v less the plane at each grain, which is the best one: what it explains is the
/// sum of its products with the momenta.
std::array<double, 6> fluctuation(const CellMoments& cell, const VelocityPlane& plane) {
  constexpr std::array<std::array<std::size_t, 2>, 6> axes{
      {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}}};
  std::array<double, 6> flux{};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [a, b] = axes[k];
    flux[k] = cell.momentum_flux[k] - plane.value[a] * cell.momentum[b] -
              plane.slope_r[a] * cell.momentum_offset_r[b] -
              plane.slope_z[a] * cell.momentum_offset_z[b];
  }
  return flux;
}

RingField unknown() {
  FieldNumbers numbers;
  numbers.fill(nan);
  return std::bit_cast<RingField>(numbers);
}

void add_motion(RingField& field, const VelocityPlane& plane, double radius) {
  field.velocity = plane.value[0];
  field.angular_velocity = field.velocity / radius;
  field.shear_rate_r = plane.slope_r[0] - field.angular_velocity;
  field.shear_rate_z = plane.slope_z[0];
  field.shear_rate = std::hypot(field.shear_rate_r, field.shear_rate_z);
}

void add_stresses(RingField& field,
                  const CellMoments& cell,
                  const std::array<double, 6>& flux,
                  double volume,
                  const ChuteConditions& c) {
  const auto total = [&](std::size_t k) { return (cell.contact_stress[k] + flux[k]) / volume; };
  field.shear_stress_r = -total(4);
  field.shear_stress_z = -total(3);
  field.shear_stress = std::hypot(field.shear_stress_r, field.shear_stress_z);
  field.pressure = (total(0) + total(1) + total(2)) / 3.0;
  field.normal_stress = total(1);
  field.friction = field.shear_stress / field.pressure;
  field.inertial_number =
      field.shear_rate * c.grain_diameter * std::sqrt(c.grain_density / field.pressure);
  field.softness = field.pressure * c.grain_diameter / c.stiffness;
  field.temperature = (flux[0] + flux[1] + flux[2]) / (3.0 * cell.mass);
}

void add_frame(std::vector<CellMoments>& sum, const RingFrame& frame, double share) {
  for (std::size_t k = 0; k < sum.size(); ++k) add_cell(sum[k], frame.cells[k], 0, 0, share);
}

std::vector<CellMoments> mean_cells(std::span<const RingFrame> frames, std::size_t size) {
  double samples = 0.0;
  for (const RingFrame& frame : frames) samples += frame.samples;
  std::vector<CellMoments> mean(size);
  for (const RingFrame& frame : frames) add_frame(mean, frame, frame.samples / samples);
  return mean;
}

/// Errors of the fields of one cell; field(moments) makes fields.
template <class Field>
RingField errors_of(const CellMoments& mean,
                    std::span<const RingFrame> frames,
                    std::size_t cell,
                    Field&& field) {
  constexpr double epsilon = 1e-5;
  const auto centre = std::bit_cast<FieldNumbers>(field(mean));
  std::array<std::vector<double>, field_numbers> series;
  for (const RingFrame& frame : frames) {
    CellMoments moved;
    add_cell(moved, mean, 0.0, 0.0, 1.0 - epsilon);
    add_cell(moved, frame.cells[cell], 0.0, 0.0, epsilon);
    const auto near = std::bit_cast<FieldNumbers>(field(moved));
    for (std::size_t k = 0; k < field_numbers; ++k) {
      series[k].push_back(centre[k] + (near[k] - centre[k]) / epsilon);
    }
  }
  FieldNumbers errors;
  for (std::size_t k = 0; k < field_numbers; ++k) errors[k] = block_average(series[k]).error;
  return std::bit_cast<RingField>(errors);
}

}  // namespace

void add_cell(
    CellMoments& sum, const CellMoments& moments, double shift_r, double shift_z, double factor) {
  constexpr std::size_t count = sizeof(CellMoments) / sizeof(double);
  using Numbers = std::array<double, count>;
  auto numbers = std::bit_cast<Numbers>(sum);
  const auto added = std::bit_cast<Numbers>(moments);
  for (std::size_t k = 0; k < count; ++k) numbers[k] += factor * added[k];
  sum = std::bit_cast<CellMoments>(numbers);
  const auto [r, z] = moments.mass_offset;
  sum.mass_offset[0] += factor * shift_r * moments.mass;
  sum.mass_offset[1] += factor * shift_z * moments.mass;
  sum.mass_offset_square[0] += factor * shift_r * (2.0 * r + shift_r * moments.mass);
  sum.mass_offset_square[1] += factor * shift_z * (2.0 * z + shift_z * moments.mass);
  sum.mass_offset_square[2] +=
      factor * (shift_r * z + shift_z * r + shift_r * shift_z * moments.mass);
  for (std::size_t a = 0; a < 3; ++a) {
    sum.momentum_offset_r[a] += factor * shift_r * moments.momentum[a];
    sum.momentum_offset_z[a] += factor * shift_z * moments.momentum[a];
  }
}

RingField ring_field(const CellMoments& cell,
                     double radius,
                     double volume,
                     const ChuteConditions& conditions) {
  constexpr double least_fraction = 0.01;  // as for rows of profiles
  RingField field;
  field.volume_fraction = cell.mass / (volume * conditions.grain_density);
  if (!(volume > 0.0) || !(field.volume_fraction > least_fraction)) return unknown();
  const VelocityPlane plane = velocity_plane(cell);
  add_motion(field, plane, radius);
  add_stresses(field, cell, fluctuation(cell, plane), volume, conditions);
  field.coordination = cell.contacts / cell.grains;
  return field;
}

RingFields ring_fields(const RingGrid& grid,
                       std::span<const RingFrame> frames,
                       const ChuteConditions& conditions) {
  RingFields fields{.grid = grid, .values = {}, .errors = {}};
  if (frames.empty()) return fields;
  const std::vector<CellMoments> mean = mean_cells(frames, grid.size());
  for (std::size_t k = 0; k < mean.size(); ++k) {
    const std::size_t column = k % grid.columns;
    const auto field = [&](const CellMoments& cell) {
      return ring_field(cell, grid.radius(column), grid.volume(column), conditions);
    };
    fields.values.push_back(field(mean[k]));
    const bool known = !std::isnan(fields.values.back().volume_fraction);
    fields.errors.push_back(known ? errors_of(mean[k], frames, k, field) : unknown());
  }
  return fields;
}

}  // namespace grainlaw::dem
