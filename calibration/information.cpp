#include "calibration/information.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "calibration/box_points.h"
#include "calibration/refit.h"

namespace grainlaw::calibration {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Rows of the weighted Jacobian, scaled by the standard errors of the numbers of the fit so that
/// the whole information has ones on the diagonal of its inverse.
Eigen::MatrixXd scaled_jacobian(const SolvedLaw& solved) {
  const Matrix& J = solved.minimum.jacobian;
  Eigen::MatrixXd result(J.rows, J.columns);
  for (int k = 0; k < J.columns; ++k) {
    const double error = std::sqrt(solved.uncertainty.covariance(k, k) / solved.scatter);
    for (int i = 0; i < J.rows; ++i) result(i, k) = J(i, k) * error;
  }
  return result;
}

/// ln det and inverse of an information matrix; none where a combination is unknown.
struct Inverse {
  double log_det = -infinity;
  Eigen::MatrixXd covariance;
};
Inverse invert(const Eigen::MatrixXd& information) {
  constexpr double rounding = 1e-12;  // of the largest eigenvalue
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(information);
  const Eigen::VectorXd& values = solver.eigenvalues();
  if (!(values.minCoeff() > rounding * values.maxCoeff())) return {};
  return {.log_det = values.array().log().sum(),
          .covariance = solver.eigenvectors() * values.cwiseInverse().asDiagonal() *
                        solver.eigenvectors().transpose()};
}

/// Places of the points of each run in a fit.
struct RunRows {
  std::vector<int> rows;
  double wall_seconds = 0.0;
};
std::map<std::string, RunRows> rows_by_run(std::span<const StatePoint> points,
                                           const std::vector<std::size_t>& used) {
  std::map<std::string, RunRows> runs;
  for (std::size_t k = 0; k < used.size(); ++k) {
    const StatePoint& point = points[used[k]];
    RunRows& run = runs[point.run.empty() ? label(point, used[k]) : point.run];
    run.rows.push_back(static_cast<int>(k));
    run.wall_seconds = point.wall_seconds;
  }
  return runs;
}

RunInformation without_run(const Eigen::MatrixXd& jacobian,
                           const Eigen::MatrixXd& information,
                           const Inverse& whole,
                           const RunRows& run) {
  Eigen::MatrixXd rest = information;
  for (const int i : run.rows) rest -= jacobian.row(i).transpose() * jacobian.row(i);
  const Inverse left = invert(rest);
  RunInformation result{.run = {},
                        .points = static_cast<int>(run.rows.size()),
                        .wall_seconds = run.wall_seconds,
                        .gain = whole.log_det - left.log_det,
                        .error_increase = {}};
  result.gain_per_second = run.wall_seconds > 0.0 ? result.gain / run.wall_seconds : nan;
  for (Eigen::Index k = 0; k < information.rows(); ++k) {
    result.error_increase.push_back(
        left.covariance.size() == 0
            ? infinity
            : std::sqrt(left.covariance(k, k) / whole.covariance(k, k)) - 1.0);
  }
  return result;
}

bool tells_more(const RunInformation& one, const RunInformation& other) {
  const bool known = std::isfinite(one.wall_seconds) && one.wall_seconds > 0.0;
  const bool other_known = std::isfinite(other.wall_seconds) && other.wall_seconds > 0.0;
  if (known != other_known) return known;
  return known ? one.gain_per_second > other.gain_per_second : one.gain > other.gain;
}

LawInformation information_of(std::span<const StatePoint> points,
                              const MaterialFit& fit,
                              Quantity quantity) {
  const ChosenLaw chosen = chosen_law(fit, quantity);
  const PointSelection selection = select_fitted(points, quantity, weights_of(fit, quantity));
  const SolvedLaw solved = solve_law(chosen.law, selection.data, chosen.active);
  LawInformation result;
  for (const std::size_t slot : chosen.active) {
    result.coefficients.push_back(chosen.law.slots[slot].name);
  }
  const Eigen::MatrixXd jacobian = scaled_jacobian(solved);
  const Eigen::MatrixXd information = jacobian.transpose() * jacobian;
  const Inverse whole = invert(information);
  if (whole.covariance.size() == 0) return result;  // the summary of the fit says what is unknown
  for (const auto& [name, run] : rows_by_run(points, selection.used)) {
    result.runs.push_back(without_run(jacobian, information, whole, run));
    result.runs.back().run = name;
  }
  std::stable_sort(result.runs.begin(), result.runs.end(), tells_more);
  return result;
}

/// The points of a fit as a part of the averaging time gives them, and what that cost.
struct PartialPoints {
  std::vector<StatePoint> points;
  std::vector<bool> found;  ///< false: not in that part, or of a run without frames
  double wall_seconds = 0.0;
};
PartialPoints measure_part(std::span<const dem::LocalData> runs,
                           std::span<const StatePoint> points,
                           double share) {
  PartialPoints part{.points = {points.begin(), points.end()}, .found = {}};
  std::vector<dem::LocalData> shorter;
  for (const dem::LocalData& run : runs) {
    const bool has_points = std::any_of(
        points.begin(), points.end(), [&](const StatePoint& p) { return p.run == run.name; });
    if (!has_points || run.frames.frames.empty()) continue;
    shorter.push_back(shortened(run, share));
    part.wall_seconds += shorter.back().summary.wall_seconds;
  }
  std::vector<std::string> ignored;
  const std::vector<StatePoint> measured = state_points(shorter, ignored);
  for (StatePoint& point : part.points) {
    const auto same = std::find_if(measured.begin(), measured.end(), [&](const StatePoint& p) {
      return p.name == point.name && p.run == point.run;
    });
    part.found.push_back(same != measured.end());
    if (part.found.back()) point = *same;
  }
  return part;
}

/// Whether a scatter can be told in standard errors: too few frames give none.
bool any_error(const std::vector<StatePoint>& points,
               const std::vector<std::size_t>& used,
               Quantity quantity) {
  return std::any_of(used.begin(), used.end(), [&](std::size_t i) {
    const double error = measured(points[i], quantity).error;
    return std::isfinite(error) && error > 0.0;
  });
}

struct PartialFit {
  std::vector<dem::Estimate> coefficients;
  double scatter = nan;
};
PartialFit fit_part(const PartialPoints& part, const MaterialFit& fit, Quantity quantity) {
  const ChosenLaw chosen = chosen_law(fit, quantity);
  std::vector<double> weights = weights_of(fit, quantity);
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= part.found[i] ? 1.0 : 0.0;
  const PointSelection selection = select_fitted(part.points, quantity, weights);
  if (selection.data.size() < chosen.active.size()) {
    throw FitError("too few points are left in this part of the averaging time");
  }
  const SolvedLaw solved = solve_law(chosen.law, selection.data, chosen.active);
  require_converged(solved.minimum, chosen.law.name);
  PartialFit result{.coefficients = table_coefficients(chosen.law, solved)};
  if (solved.freedom() > 0 && any_error(part.points, selection.used, quantity)) {
    result.scatter = std::sqrt(solved.minimum.chi_squared / solved.freedom());
  }
  return result;
}

CostPoint cost_at(std::span<const dem::LocalData> runs,
                  std::span<const StatePoint> points,
                  const MaterialFit& fit,
                  double share) {
  CostPoint result;
  result.share = share;
  try {
    const PartialPoints part = measure_part(runs, points, share);
    result.dem_wall_seconds = part.wall_seconds;
    PartialFit friction = fit_part(part, fit, Quantity::friction);
    PartialFit fraction = fit_part(part, fit, Quantity::volume_fraction);
    result.friction = std::move(friction.coefficients);
    result.volume_fraction = std::move(fraction.coefficients);
    result.friction_scatter = friction.scatter;
    result.fraction_scatter = fraction.scatter;
  } catch (const FitError& error) {
    result.failure = error.what();
  }
  return result;
}

}  // namespace

LawInformation friction_information(std::span<const StatePoint> points, const MaterialFit& fit) {
  return information_of(points, fit, Quantity::friction);
}

LawInformation fraction_information(std::span<const StatePoint> points, const MaterialFit& fit) {
  return information_of(points, fit, Quantity::volume_fraction);
}

std::vector<CostPoint> cost_of_coefficients(std::span<const dem::LocalData> runs,
                                            std::span<const StatePoint> points,
                                            const MaterialFit& fit) {
  const bool frames = std::any_of(runs.begin(), runs.end(), [](const dem::LocalData& run) {
    return !run.frames.frames.empty();
  });
  std::vector<CostPoint> result;
  for (const double share : {1.0 / 16.0, 0.125, 0.25, 0.5, 1.0}) {
    if (frames) result.push_back(cost_at(runs, points, fit, share));
  }
  return result;
}

}  // namespace grainlaw::calibration
