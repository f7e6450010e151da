#include "calibration/nonlocal_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "calibration/least_squares.h"

namespace grainlaw::calibration {
namespace {

using continuum::ProfileRow;

constexpr double start_amplitude = 0.5;  // glass beads: 0.48 (Henann & Kamrin 2013)
/// Rows of the model: linear interpolation between them is good to 1e-4 of the velocity.
constexpr int model_rows = 801;

double interpolated(const std::vector<ProfileRow>& rows, double position) {
  const auto above = std::ranges::lower_bound(rows, position, {}, &ProfileRow::z);
  if (above == rows.begin()) return above->velocity;
  if (above == rows.end()) return rows.back().velocity;
  const ProfileRow& below = *(above - 1);
  const double share = (position - below.z) / (above->z - below.z);
  return below.velocity + share * (above->velocity - below.velocity);
}

/// Residuals at the points; not a number where nothing flows.
class Misfit {
 public:
  Misfit(const std::vector<BandPoint>& points, const VelocityModel& model, double step)
      : points_(points), model_(model), step_(step) {}

  void values(double amplitude, std::span<double> r) const {
    std::vector<double> velocity = model_(std::abs(amplitude));  // only A^2 enters
    velocity.resize(points_.size(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < points_.size(); ++i)
      r[i] = (velocity[i] - points_[i].velocity) / points_[i].error;
  }

  void slopes(double amplitude, std::span<double> jacobian) const {
    std::vector<double> low(jacobian.size());
    values(amplitude + step_, jacobian);
    values(amplitude - step_, low);
    for (std::size_t i = 0; i < low.size(); ++i)
      jacobian[i] = (jacobian[i] - low[i]) / (2.0 * step_);
  }

 private:
  const std::vector<BandPoint>& points_;
  const VelocityModel& model_;
  double step_;
};

void check(const std::vector<BandPoint>& points) {
  if (points.size() < 4) throw FitError("fewer than 4 points of velocity do not fix a band");
  for (const BandPoint& point : points)
    if (!(std::isfinite(point.velocity) && std::isfinite(point.position) && point.error > 0.0))
      throw FitError("a point of the band is not finite or has no standard error");
}

/// A is 0.4 to 0.9 for grains. A band whose velocities move by less than one standard error in all
/// between 0 and 1 says nothing of it. (The slope in A would not tell: only A^2 enters.)
void require_sensitivity(const Misfit& residuals, std::size_t points) {
  std::vector<double> local(points), nonlocal(points);
  residuals.values(0.0, local);
  residuals.values(1.0, nonlocal);
  double change = 0.0;
  for (std::size_t k = 0; k < points; ++k) change += std::pow(nonlocal[k] - local[k], 2);
  if (change < 1.0) {
    throw FitError(
        "this band does not tell the nonlocal amplitude A: tau/p is uniform in it, or nearly; a "
        "plane shear with gravity does, and so does a box driven by a body force");
  }
}

double sum_of_squares(const std::vector<double>& residuals) {
  double sum = 0.0;
  for (const double r : residuals) sum += r * r;
  return sum;
}

}  // namespace

NonlocalFit fit_nonlocal_amplitude(const std::vector<BandPoint>& points,
                                   const VelocityModel& model,
                                   double step) {
  const auto start = std::chrono::steady_clock::now();
  check(points);
  const Misfit residuals(points, model, step);
  require_sensitivity(residuals, points.size());
  const LeastSquaresProblem problem{
      .unknowns = {{"A", start_amplitude, 0.0}},
      .residuals = static_cast<int>(points.size()),
      .evaluate = [&](std::span<const double> x, std::span<double> r, std::span<double> jacobian) {
        residuals.values(x[0], r);
        if (!jacobian.empty()) residuals.slopes(x[0], jacobian);
      }};
  const Minimum minimum = minimise(problem);
  require_converged(minimum, "the nonlocal amplitude A");
  NonlocalFit fit;
  fit.summary = describe({"A"}, minimum, uncertainty(problem, minimum));
  fit.amplitude = std::abs(minimum.values[0]);
  fit.error = fit.summary["A"].error;
  fit.points = static_cast<int>(points.size());
  std::vector<double> local(points.size());
  residuals.values(0.0, local);
  fit.local_chi_squared = sum_of_squares(local);
  fit.summary.notes.emplace_back(
      "points taken as independent; errors of mu(I) and phi(I) are not in the error of A");
  fit.summary.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return fit;
}

NonlocalFit fit_nonlocal_amplitude(const continuum::RheologyTable& table,
                                   const continuum::ShearBandCase& band,
                                   const std::vector<BandPoint>& points) {
  constexpr double step = 1e-4;  // the model is smooth in A down to rounding of 1e-10
  const auto velocities = [&](double amplitude) {
    continuum::ShearBandCase at = band;
    at.nonlocal_amplitude = amplitude;
    const auto found =
        continuum::shear_band(table, at, {.cells = 800, .most_cells = 800, .rows = model_rows});
    std::vector<double> result;
    if (!flows(found.answer.outcome)) return result;
    for (const BandPoint& point : points)
      result.push_back(interpolated(found.profile.rows, point.position));
    return result;
  };
  return fit_nonlocal_amplitude(points, velocities, step);
}

}  // namespace grainlaw::calibration
