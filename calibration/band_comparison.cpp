#include "calibration/band_comparison.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "calibration/fit_summary.h"
#include "calibration/least_squares.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

using continuum::BodyForceBox;
using continuum::ShearBand;
using continuum::ShearBandCase;
using dem::LocalRow;
using Rows = std::vector<LocalRow>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

bool is_box(const ShearBandCase& band) {
  return std::holds_alternative<BodyForceBox>(band.flow);
}

double period(const dem::LocalData& measured) {
  const auto& frames = measured.frames.frames;
  return frames.empty() ? 0.0
                        : measured.frames.bin_width * static_cast<double>(frames[0].bins.size());
}

/// The velocity of the centre of mass of the rows is taken off.
void centre(Rows& rows) {
  double mass = 0.0, momentum = 0.0;
  for (const LocalRow& row : rows) {
    mass += row.volume_fraction.value;
    momentum += row.volume_fraction.value * row.velocity.value;
  }
  for (LocalRow& row : rows) row.velocity.value -= momentum / mass;
}

void stretch(Rows& rows, double factor) {
  for (LocalRow& row : rows) row.z *= factor;
}

MeasuredRows box_rows(const dem::LocalData& measured, double predicted_height) {
  MeasuredRows result{.rows = measured.rows, .blocks = block_rows(measured), .dense = {}};
  const double factor = predicted_height / period(measured);
  const auto as_predicted = [&](Rows& rows) {
    centre(rows);
    stretch(rows, factor);
  };
  as_predicted(result.rows);
  for (Rows& rows : result.blocks) as_predicted(rows);
  result.dense.assign(result.rows.size(), true);
  return result;
}

/// Position, towards `direction` from `from`, at which the velocity of a period first reaches
/// `value` in size; rows are met again after the last one. Not a number where it never does.
double reaching(const Rows& rows, double from, int direction, double value) {
  const auto n = static_cast<std::ptrdiff_t>(rows.size());
  const double width = rows[1].z - rows[0].z;
  const auto velocity = [&](std::ptrdiff_t k) {
    return std::abs(rows[static_cast<std::size_t>((k % n + n) % n)].velocity.value);
  };
  const auto start = static_cast<std::ptrdiff_t>(std::floor((from - rows[0].z) / width));
  const std::ptrdiff_t first = direction > 0 ? start + 1 : start;
  for (std::ptrdiff_t step = 0; step < n; ++step) {
    const std::ptrdiff_t k = first + direction * step;
    if (velocity(k) < value) continue;
    const double position = rows[0].z + static_cast<double>(k) * width;
    const double before = step == 0 ? 0.0 : velocity(k - direction);
    const double share = (velocity(k) - value) / std::max(velocity(k) - before, 1e-300);
    return std::abs(position - from) - share * width;
  }
  return nan;
}

double largest_velocity(const Rows& rows) {
  const auto [low, high] =
      std::ranges::minmax(rows, {}, [](const LocalRow& row) { return row.velocity.value; });
  return 0.5 * (high.velocity.value - low.velocity.value);
}

/// Both flanks of a band together, the mean of the two bands; a shift of the bands cancels.
double box_width(const Rows& rows, double height) {
  const double wanted = 0.9 * largest_velocity(rows);
  double sum = 0.0;
  for (const double band : {0.0, 0.5 * height}) {
    for (const int direction : {-1, 1}) sum += reaching(rows, band, direction, wanted);
  }
  return 0.5 * sum;
}

/// From the upper end of the layer down to where a tenth of the speed of the wall is left.
double wall_width(const Rows& rows, double height, double speed) {
  for (std::size_t k = rows.size(); k-- > 0;) {
    const double here = rows[k].velocity.value;
    if (here > 0.1 * speed) continue;
    if (k + 1 == rows.size()) return height - rows[k].z;
    const double above = rows[k + 1].velocity.value;
    const double share = (0.1 * speed - here) / (above - here);
    return height - (rows[k].z + share * (rows[k + 1].z - rows[k].z));
  }
  return height;
}

/// Mean over the rows the kernel keeps clear of the walls.
double shear_stress(const Rows& rows, const std::vector<bool>& dense) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!dense[i]) continue;
    sum += rows[i].shear_stress.value;
    ++count;
  }
  return count > 0 ? sum / count : nan;
}

/// A number of the rows with its jackknife error over the blocks.
dem::Estimate estimate(const MeasuredRows& measured,
                       const std::function<double(const Rows&)>& number) {
  dem::Estimate result{.value = number(measured.rows)};
  std::vector<double> without;
  for (std::size_t b = 0; b < measured.blocks.size(); ++b) {
    without.push_back(number(mean_without(measured.blocks, b)));
  }
  if (!without.empty()) result.error = jackknife_error(without);
  return result;
}

/// Positions at which the velocities of a plane shear are looked up when its no-slip heights are
/// free.
double between(double z, const NoSlipHeights& heights, double height) {
  return height * (z - heights.lower) / (height - heights.lower - heights.upper);
}

/// The lower quarter stands still: nothing tells where the wall holds it.
bool creeps_at_bottom(const Rows& rows) {
  const double velocity = rows[rows.size() / 4].velocity.value;
  return std::abs(velocity) < 0.01 * std::abs(rows.back().velocity.value);
}

/// The predicted shape between free no-slip heights, fitted to the measured velocities.
NoSlipHeights fit_no_slip(const MeasuredRows& measured, const continuum::Profile& profile) {
  const Rows& rows = measured.rows;
  std::vector<std::size_t> all(rows.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const std::vector<double> errors = weight_errors(rows, all, &LocalRow::velocity);
  const auto residuals = [&](const NoSlipHeights& heights, std::span<double> r) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double z = between(rows[i].z, heights, profile.height);
      r[i] = (velocity_at(profile, z) - rows[i].velocity.value) / errors[i];
    }
  };
  const LeastSquaresProblem problem{
      .unknowns = {{.name = "lower", .held = creeps_at_bottom(rows)}, {.name = "upper"}},
      .residuals = static_cast<int>(rows.size()),
      .evaluate = [&](std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
        residuals({x[0], x[1]}, r);
        if (jacobian.empty()) return;
        const double step = 1e-3 * profile.height;  // wider than the rows of the profile
        std::vector<double> high(r.size()), low(r.size());
        for (std::size_t j = 0; j < 2; ++j) {
          const double dl = j == 0 ? step : 0.0, du = step - dl;
          residuals({x[0] + dl, x[1] + du}, high);
          residuals({x[0] - dl, x[1] - du}, low);
          for (std::size_t i = 0; i < r.size(); ++i)
            jacobian[2 * i + j] = (high[i] - low[i]) / (2.0 * step);
        }
      }};
  const Minimum minimum = minimise(problem);
  return {minimum.values[0], minimum.values[1]};
}

/// Relative L2 of the velocities that the no-slip heights move.
double distance(const MeasuredRows& measured,
                const continuum::Profile& profile,
                const NoSlipHeights& heights) {
  double sum = 0.0, norm = 0.0;
  for (const LocalRow& row : measured.rows) {
    const double z = between(row.z, heights, profile.height);
    sum += std::pow(velocity_at(profile, z) - velocity_at(profile, row.z), 2);
    norm += row.velocity.value * row.velocity.value;
  }
  return std::sqrt(sum / norm);
}

void compare_walls(const MeasuredRows& measured,
                   const continuum::PlaneShear& flow,
                   const ShearBand& predicted,
                   double diameter,
                   BandComparison& result) {
  const double speed = flow.drive.velocity.value_or(measured.rows.back().velocity.value);
  const double top = measured.rows.back().z + 0.5 * (measured.rows[1].z - measured.rows[0].z);
  result.height = top;
  result.width = estimate(measured, [&](const Rows& r) { return wall_width(r, top, speed); });
  result.drive =
      predicted.sought == ShearBand::Sought::stress
          ? estimate(measured, [&](const Rows& r) { return shear_stress(r, measured.dense); })
          : measured.rows.back().velocity;
  if (predicted.local_band_collapse) return;  // any shift of so thin a band explains everything
  const NoSlipHeights found = fit_no_slip(measured, predicted.profile);
  const double most = farthest_no_slip * diameter;
  if (!(std::abs(found.lower) < most && std::abs(found.upper) < most)) return;
  result.no_slip = found;
  result.budget.geometry = distance(measured, predicted.profile, found);
}

void compare_box(const dem::LocalData& data, const MeasuredRows& measured, BandComparison& result) {
  result.height = period(data);
  const double stretched = measured.rows.back().z + measured.rows.front().z;
  result.width = estimate(measured, [&](const Rows& r) { return box_width(r, stretched); });
  const double back = result.height / stretched;
  result.width.value *= back;
  result.width.error *= back;
  result.drive = estimate(measured, largest_velocity);
  result.profile.flux = {};
}

/// Every n-th row such that their distance is at least twice the width of the kernel, off the
/// walls.
std::vector<std::size_t> independent_rows(const MeasuredRows& measured, double distance) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < measured.rows.size(); ++i) {
    if (!measured.dense[i]) continue;
    const bool far = chosen.empty() ||
                     measured.rows[i].z - measured.rows[chosen.back()].z >= distance * (1.0 - 1e-9);
    if (far) chosen.push_back(i);
  }
  return chosen;
}

/// z = 0 to the upper end of the layer; phi and mu within reach of neither wall.
MeasuredRows layer_rows(const dem::LocalData& measured) {
  MeasuredRows result = measured_rows(measured);
  const double reach = measured.frames.kernel.reach();
  for (std::size_t i = 0; i < result.rows.size(); ++i) {
    if (result.rows[i].z < reach) result.dense[i] = false;
  }
  return result;
}

}  // namespace

MeasuredRows band_rows(const dem::LocalData& measured,
                       const ShearBandCase& band,
                       double predicted_height) {
  MeasuredRows rows = is_box(band) ? box_rows(measured, predicted_height) : layer_rows(measured);
  if (rows.rows.size() < 2)
    throw FitError("run '" + measured.name + "': fewer than two rows of a band to compare");
  return rows;
}

BandComparison compare_band(const dem::LocalData& measured,
                            const ShearBandCase& band,
                            const ShearBand& predicted) {
  if (predicted.profile.rows.empty())
    throw FitError("run '" + measured.name + "': the prediction has no profile to compare");
  const MeasuredRows rows = band_rows(measured, band, predicted.profile.height);
  BandComparison result;
  result.profile = profile_error(predict_at(predicted.profile, rows.rows), rows);
  result.profile.surface_velocity = {};
  if (const auto* walls = std::get_if<continuum::PlaneShear>(&band.flow)) {
    compare_walls(rows, *walls, predicted, measured.conditions.grain_diameter, result);
  } else {
    compare_box(measured, rows, result);
  }
  const double sought = predicted.sought == ShearBand::Sought::stress ? predicted.driving_stress
                                                                      : predicted.driving_velocity;
  const double ratio = sought / result.drive.value;
  result.drive_difference = {ratio - 1.0, ratio * result.drive.error / result.drive.value};
  result.budget.total = result.profile.velocity.value;
  result.budget.statistics = result.profile.statistics;
  result.budget.law = result.profile.law;
  result.budget.numerics = predicted.discretisation_error;
  return result;
}

std::vector<BandPoint> band_points(const dem::LocalData& measured,
                                   const ShearBandCase& band,
                                   double predicted_height) {
  const MeasuredRows rows = band_rows(measured, band, predicted_height);
  const double stretched = is_box(band) ? predicted_height / period(measured) : 1.0;
  const auto chosen = independent_rows(rows, 2.0 * measured.frames.kernel.width * stretched);
  const std::vector<double> errors = weight_errors(rows.rows, chosen, &LocalRow::velocity);
  std::vector<BandPoint> points;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const LocalRow& row = rows.rows[chosen[i]];
    points.push_back({row.z, row.velocity.value, errors[i]});
  }
  return points;
}

}  // namespace grainlaw::calibration
