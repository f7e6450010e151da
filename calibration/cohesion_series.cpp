#include "calibration/cohesion_series.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "calibration/bagnold_solve.h"
#include "calibration/model_choice.h"
#include "calibration/mu_phi_fit.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

namespace slot = bagnold_slot;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

CohesivePoint point_of(const SeriesRun& entry) {
  const dem::LocalData& run = *entry.run;
  const dem::ChuteConditions& grains = run.conditions;
  Observations rows = select_rows(run, {});
  CohesivePoint point{.name = run.name, .series = entry.series};
  point.attraction = grains.attraction / grain_weight(grains);
  point.inclination = grains.inclination;
  point.layer_height = run.rows[rows.rows.back()].z / grains.grain_diameter;
  point.plug = find_plug(run, rows);
  if (point.plug) leave_out_plug(run, *point.plug, rows);
  const BagnoldInput input = prepare(run, rows);
  const SolvedBagnold pairs = solve_bagnold(input, stress_rate_pairs(true));
  const auto k = static_cast<std::size_t>(pairs.unknown(slot::tau_c));
  const int column = static_cast<int>(k);
  point.yield_stress = {pairs.values[slot::tau_c],
                        std::sqrt(pairs.uncertainty.covariance(column, column))};
  point.at_bound = pairs.minimum.at_bound[k];
  point.cohesion = {nan, nan};
  return point;
}

std::optional<dem::Estimate> friction_at_rest(std::span<const SeriesRun> runs,
                                              std::vector<std::string>& left_out) {
  std::vector<dem::LocalData> loose;
  for (const SeriesRun& entry : runs) {
    if (entry.run->conditions.attraction == 0.0 && entry.run->window.steady) {
      loose.push_back(*entry.run);
    }
  }
  try {
    if (loose.size() < 3) throw FitError("three chutes without cohesion are needed");
    const FittedCoefficient mu0 = fit_mu_phi(loose).friction["mu0"];
    return dem::Estimate{mu0.value, mu0.error};
  } catch (const FitError& error) {
    left_out.push_back(std::string("mu0, and with it c0: ") + error.what());
    return std::nullopt;
  }
}

/// c0 at every tilt share the error of mu0: generalised least squares of one value.
PooledCohesion pool(const std::vector<const CohesivePoint*>& points, const dem::Estimate& mu0) {
  const auto n = static_cast<Eigen::Index>(points.size());
  Eigen::VectorXd c0(n);
  Eigen::VectorXd own(n);
  Eigen::VectorXd shared(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const CohesivePoint& point = *points[static_cast<std::size_t>(k)];
    const double tangent = std::tan(point.inclination);
    c0[k] = point.cohesion.value;
    own[k] = point.yield_stress.error * (1.0 - mu0.value / tangent);
    shared[k] = point.yield_stress.value * mu0.error / tangent;
  }
  const Eigen::MatrixXd covariance =
      own.cwiseAbs2().asDiagonal().toDenseMatrix() + shared * shared.transpose();
  const Eigen::LDLT<Eigen::MatrixXd> solver(covariance);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(n);
  const double weight = ones.dot(solver.solve(ones));
  PooledCohesion result{.series = points.front()->series,
                        .attraction = points.front()->attraction,
                        .tilts = static_cast<int>(n)};
  result.cohesion = {ones.dot(solver.solve(c0)) / weight, std::sqrt(1.0 / weight)};
  const Eigen::VectorXd off = c0.array() - result.cohesion.value;
  const double freedom = static_cast<double>(n - 1);
  constexpr double very_many = 1e6;
  result.chance =
      n > 1 ? f_survival(off.dot(solver.solve(off)) / freedom, freedom, very_many) : nan;
  return result;
}

void add_cohesion(CohesionSeries& series) {
  if (!series.mu0) return;
  for (CohesivePoint& point : series.points) {
    const double tangent = std::tan(point.inclination);
    if (tangent <= series.mu0->value) continue;
    point.cohesion = material_cohesion(point.yield_stress, point.inclination, series.mu0->value);
    point.cohesion.error =
        std::hypot(point.cohesion.error, point.yield_stress.value * series.mu0->error / tangent);
  }
  // Runs of two series differ in more than their tilt, even where the attraction is the same.
  std::map<std::pair<std::string, double>, std::vector<const CohesivePoint*>> materials;
  for (const CohesivePoint& point : series.points) {
    const bool counts = point.attraction > 0.0 && std::isfinite(point.cohesion.value);
    if (counts && point.cohesion.error > 0.0) {
      materials[{point.series, point.attraction}].push_back(&point);
    }
  }
  for (const auto& [material, points] : materials) {
    series.pooled.push_back(pool(points, *series.mu0));
  }
}

}  // namespace

CohesionSeries cohesion_series(std::span<const SeriesRun> runs) {
  CohesionSeries series;
  series.mu0 = friction_at_rest(runs, series.left_out);
  for (const SeriesRun& entry : runs) {
    try {
      series.points.push_back(point_of(entry));
    } catch (const FitError& error) {
      series.left_out.push_back(entry.run->name + ": " + error.what());
    }
  }
  add_cohesion(series);
  return series;
}

}  // namespace grainlaw::calibration
