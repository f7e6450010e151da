#include "calibration/box_points.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "calibration/observations.h"
#include "calibration/ordered_boxes.h"
#include "calibration/state_comparison.h"
#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

using dem::FieldRow;
using dem::LocalRow;

double bond_number(const dem::ChuteConditions& grains, double stress) {
  return grains.attraction / (stress * grains.grain_diameter * grains.grain_diameter);
}

/// Fields of one row in every frame of the steady window.
std::vector<FieldRow> frame_fields(const dem::LocalData& run, double z) {
  const dem::ProfileFrames& grid = run.frames;
  std::vector<FieldRow> fields;
  for (const dem::ProfileFrame& frame : dem::frames_inside(grid, run.window)) {
    const auto rows =
        dem::coarse_grain(dem::mean_moments({&frame, 1}), grid, grid.kernel, run.conditions);
    fields.push_back(rows[field_row_at(grid, z)]);
  }
  return fields;
}

/// Correlation of the errors of two means, from those of their sum and difference: var(a + b) -
/// var(a - b) = 4 cov(a, b), every one by block averaging. 0 where it is not known.
double error_correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const double a_error = dem::block_average(a).error;
  const double b_error = dem::block_average(b).error;
  if (!(a_error > 0.0 && b_error > 0.0)) return 0.0;
  std::vector<double> sum, difference;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum.push_back(a[k] / a_error + b[k] / b_error);
    difference.push_back(a[k] / a_error - b[k] / b_error);
  }
  const double plus = dem::block_average(sum).error;
  const double minus = dem::block_average(difference).error;
  return std::clamp(0.25 * (plus * plus - minus * minus), -1.0, 1.0);
}

double friction_fraction_correlation(const dem::LocalData& run, double z) {
  std::vector<double> friction, fraction;
  for (const FieldRow& field : frame_fields(run, z)) {
    friction.push_back(std::abs(field.friction));
    fraction.push_back(field.volume_fraction);
  }
  return error_correlation(friction, fraction);
}

StatePoint point_of(const dem::LocalData& run, const LocalRow& row) {
  StatePoint point = state_of(row, run.conditions, run.name);
  point.correlation = friction_fraction_correlation(run, row.z);
  point.run = run.name;
  point.place = row.z;
  point.wall_seconds = run.summary.wall_seconds;
  return point;
}

/// Slope of the velocity profile of a box in each frame over the imposed one, less 1: a straight
/// line through all grains, so 0 in homogeneous shear.
std::vector<double> slope_deviations(const dem::LocalData& run) {
  std::vector<double> deviations;
  for (const dem::ProfileFrame& frame : dem::frames_inside(run.frames, run.window)) {
    // Moments of the whole box hold velocities relative to the imposed profile.
    const dem::BinMoments& box = frame.bins.front();
    const double offset = box.mass_offset / box.mass;
    const double variance = box.mass_offset_squared / box.mass - offset * offset;
    const double covariance = (box.momentum_offset[0] - offset * box.momentum[0]) / box.mass;
    deviations.push_back(covariance / (variance * run.conditions.shear_rate));
  }
  return deviations;
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// A band that takes a share s of the shear rate of a box, at a place that is equally likely
/// everywhere, makes the slope of a line through the velocities deviate by s / sqrt(5) in the root
/// mean square: a step at c gives 6 (1/4 - c^2) of the mean slope, c in box heights.
std::string not_homogeneous(const dem::LocalData& run) {
  constexpr double half_of_the_shear = 0.5 * 0.44721;
  const std::vector<double> deviations = slope_deviations(run);
  if (deviations.empty()) return {};
  const double rms = root_mean_square(deviations);
  if (rms < half_of_the_shear) return {};
  std::ostringstream text;
  text.precision(2);
  text << "not homogeneous: the slope of the velocity over the box deviates from the imposed shear "
          "rate by "
       << 100.0 * rms << " % (rms), as if a band took "
       << 100.0 * std::min(1.0, rms * std::sqrt(5.0)) << " % of the shear";
  return text.str();
}

/// Why a box is no state of steady homogeneous flow; empty: it is.
std::string defect(const dem::LocalData& run) {
  if (!run.window.steady) return "not steady: " + run.window.reason;
  return run.frames.frames.empty() ? std::string() : not_homogeneous(run);
}

void require_geometry(const dem::LocalData& run, bool right, const char* asked) {
  if (right && !run.rows.empty()) return;
  throw FitError("run '" + run.name + "' (" + run.conditions.geometry + ") " +
                 (right ? "has no rows: nothing was averaged" : asked));
}

/// Walls of plane shear, where rows are layered: z = 0 and the surface of the flow, which rows
/// reach beyond as far as the kernel. A periodic box has none.
bool near_wall(const dem::LocalData& run, double surface, double z, double distance) {
  return !run.frames.periodic && (z < distance || z > surface - distance);
}

double surface_of(const dem::LocalData& run) {
  const std::vector<LocalRow> rows = measured_rows(run).rows;
  return rows.empty() ? 0.0 : rows.back().z + 0.5 * run.frames.row_width();
}

bool flows(const LocalRow& row) {
  constexpr double clearly = 3.0;  // standard errors
  const bool down_the_gradient = row.shear_rate.value * row.friction.value > 0.0;
  return down_the_gradient && std::abs(row.shear_rate.value) > clearly * row.shear_rate.error;
}

void report(const dem::LocalData& run,
            int rows,
            const std::string& reason,
            std::vector<std::string>& left_out) {
  if (rows == 0) return;
  left_out.push_back(run.name + ": " + std::to_string(rows) + (rows == 1 ? " row " : " rows ") +
                     reason);
}

}  // namespace

StatePoint box_point(const dem::LocalData& run) {
  require_geometry(
      run, run.conditions.geometry == "simple_shear", "is no simple shear: it has no single state");
  StatePoint point = point_of(run, run.rows.front());
  point.unfit = defect(run);
  return point;
}

ProfilePoints profile_points(const dem::LocalData& run) {
  const std::string& kind = run.conditions.geometry;
  require_geometry(run,
                   kind == "plane_shear" || kind == "body_force_box",
                   "has no rows of different I: points come from plane shear and body-force boxes");
  ProfilePoints result;
  if (!run.window.steady) {
    result.left_out.push_back(run.name + ": not steady: " + run.window.reason);
    return result;
  }
  const double spacing = 2.0 * run.frames.kernel.width;
  const double rounding = 1e-9 * spacing;
  const double period = static_cast<double>(run.rows.size()) * run.frames.row_width();
  const double surface = surface_of(run);
  int close = 0, wall = 0, still = 0;
  std::optional<double> first, last;
  for (const LocalRow& row : run.rows) {
    const bool wraps = run.frames.periodic && first && *first + period - row.z < spacing - rounding;
    if (near_wall(run, surface, row.z, spacing - rounding)) {
      ++wall;
    } else if (!flows(row)) {
      ++still;
    } else if ((last && row.z - *last < spacing - rounding) || wraps) {
      ++close;
    } else {
      if (!first) first = row.z;
      last = row.z;
      result.points.push_back(point_of(run, row));
      std::ostringstream place;
      place.precision(4);
      place << " at " << row.z / run.conditions.grain_diameter << " d";
      result.points.back().name += place.str();
    }
  }
  report(run, wall, "within 2 w of a wall", result.left_out);
  report(run, still, "that hardly shear (below 3 standard errors)", result.left_out);
  report(run, close, "closer than 2 w to one that is used", result.left_out);
  return result;
}

std::vector<StatePoint> state_points(std::span<const dem::LocalData> runs,
                                     std::vector<std::string>& left_out) {
  std::vector<StatePoint> points;
  for (const dem::LocalData& run : runs) {
    try {
      if (run.conditions.geometry == "simple_shear") {
        points.push_back(box_point(run));
        continue;
      }
      const ProfilePoints rows = profile_points(run);
      points.insert(points.end(), rows.points.begin(), rows.points.end());
      left_out.insert(left_out.end(), rows.left_out.begin(), rows.left_out.end());
    } catch (const FitError& error) {
      left_out.emplace_back(error.what());
    }
  }
  mark_ordered(points);
  return points;
}

MeasuredState measured_state(const FieldRow& field, const dem::ChuteConditions& grains) {
  return {.state = {std::abs(field.inertial_number),
                    field.softness,
                    bond_number(grains, field.normal_stress)},
          .friction = std::abs(field.friction),
          .volume_fraction = field.volume_fraction};
}

std::size_t field_row_at(const dem::ProfileFrames& grid, double z) {
  return static_cast<std::size_t>((z - grid.z_begin) / grid.row_width()) +
         dem::margin_rows(grid, grid.kernel);
}

dem::LocalData shortened(const dem::LocalData& run, double share) {
  dem::LocalData result = run;
  result.window.end = run.window.begin + share * (run.window.end - run.window.begin);
  result.rows = dem::average(run.frames, run.conditions, result.window);
  if (result.rows.empty()) {
    throw FitError("run '" + run.name + "' has no frame within " + std::to_string(share) +
                   " of its steady window");
  }
  const dem::RunSummary& cost = run.summary;
  result.summary.wall_seconds =
      cost.startup_wall_seconds + share * (cost.wall_seconds - cost.startup_wall_seconds);
  return result;
}

}  // namespace grainlaw::calibration
