#include "calibration/least_squares.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

namespace grainlaw::calibration {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Keeps the log of the minimiser quiet while it lives: a library does not print.
class SilentLog {
 public:
  SilentLog() : level_(FLAGS_minloglevel) { FLAGS_minloglevel = google::GLOG_FATAL; }
  ~SilentLog() { FLAGS_minloglevel = level_; }
  SilentLog(const SilentLog&) = delete;
  SilentLog& operator=(const SilentLog&) = delete;

 private:
  int level_;
};

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

/// One parameter block of size 1 per unknown, so that each can be held constant by itself.
class Cost final : public ceres::CostFunction {
 public:
  explicit Cost(const LeastSquaresProblem& problem) : problem_(problem) {
    set_num_residuals(problem.residuals);
    mutable_parameter_block_sizes()->assign(problem.unknowns.size(), 1);
  }

  bool Evaluate(double const* const* blocks, double* r, double** jacobians) const override {
    const std::size_t n = problem_.unknowns.size();
    const auto m = static_cast<std::size_t>(problem_.residuals);
    std::vector<double> x(n);
    for (std::size_t j = 0; j < n; ++j) x[j] = *blocks[j];
    std::vector<double> dense(jacobians != nullptr ? m * n : 0);
    problem_.evaluate(x, {r, m}, dense);
    if (!all_finite({r, m}) || !all_finite(dense)) return false;
    for (std::size_t j = 0; jacobians != nullptr && j < n; ++j) {
      for (std::size_t i = 0; jacobians[j] != nullptr && i < m; ++i) {
        jacobians[j][i] = dense[i * n + j];
      }
    }
    return true;
  }

 private:
  const LeastSquaresProblem& problem_;
};

ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 500;
  // The minimum is wanted to rounding: its distance from the data must not depend on the path.
  // So a small change of the sum of squares is no reason to stop, only a step lost in rounding.
  options.function_tolerance = 0.0;
  options.parameter_tolerance = 1e-14;
  options.gradient_tolerance = 1e-15;
  options.max_num_consecutive_invalid_steps = 50;
  return options;
}

/// Minimises from minimum.values with the unknowns at their bound held there.
void minimise_free(const LeastSquaresProblem& problem, Minimum& minimum) {
  const SilentLog silent;
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  Cost cost(problem);
  ceres::Problem ceres_problem(ownership);
  std::vector<double*> blocks;
  for (double& value : minimum.values) blocks.push_back(&value);
  ceres_problem.AddResidualBlock(&cost, nullptr, blocks);
  for (std::size_t j = 0; j < blocks.size(); ++j) {
    if (minimum.at_bound[j] || problem.unknowns[j].held)
      ceres_problem.SetParameterBlockConstant(blocks[j]);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(), &ceres_problem, &summary);
  minimum.iterations += static_cast<int>(summary.iterations.size());
  minimum.converged = summary.termination_type == ceres::CONVERGENCE;
  minimum.termination = summary.message;
}

void evaluate_at(const LeastSquaresProblem& problem, Minimum& minimum) {
  const int n = static_cast<int>(problem.unknowns.size());
  minimum.residuals.assign(static_cast<std::size_t>(problem.residuals), 0.0);
  minimum.jacobian = Matrix(problem.residuals, n);
  problem.evaluate(minimum.values, minimum.residuals, minimum.jacobian.values);
  minimum.chi_squared = 0.0;
  for (const double r : minimum.residuals) minimum.chi_squared += r * r;
}

/// The free unknown furthest below its bound in units of its own standard error, or -1.
int worst_violation(const LeastSquaresProblem& problem, const Minimum& minimum) {
  int worst = -1;
  double largest = 0.0;
  for (std::size_t j = 0; j < problem.unknowns.size(); ++j) {
    const double below = problem.unknowns[j].lower - minimum.values[j];
    if (minimum.at_bound[j] || problem.unknowns[j].held || !(below > 0.0)) continue;
    double weight = 0.0;
    for (int i = 0; i < minimum.jacobian.rows; ++i) {
      weight += std::pow(minimum.jacobian(i, static_cast<int>(j)), 2);
    }
    const double violation = std::isfinite(weight) ? below * std::sqrt(weight) : below;
    if (worst < 0 || violation > largest) {
      worst = static_cast<int>(j);
      largest = violation;
    }
  }
  return worst;
}

/// The step from `start` moved the solution by less than a millionth of a standard error. Rounding
/// of the sum of squares blurs the minimum by about 1e-8 sqrt(chi^2) of one, a hundred times less.
bool settled(const Minimum& minimum, const std::vector<double>& start) {
  double moved = 0.0;
  for (int i = 0; i < minimum.jacobian.rows; ++i) {
    double change = 0.0;
    for (int j = 0; j < minimum.jacobian.columns; ++j) {
      const auto k = static_cast<std::size_t>(j);
      change += minimum.jacobian(i, j) * (minimum.values[k] - start[k]);
    }
    moved += change * change;
  }
  return std::sqrt(moved) <= 1e-6 * std::max(1.0, std::sqrt(minimum.chi_squared));
}

Eigen::Map<const RowMajor> view(const Matrix& matrix) {
  return {matrix.values.data(), matrix.rows, matrix.columns};
}

std::string combination(const LeastSquaresProblem& problem, const Eigen::VectorXd& direction) {
  std::ostringstream text;
  text.precision(2);
  text << "the data do not determine the combination ";
  const char* separator = "";
  for (Eigen::Index j = 0; j < direction.size(); ++j) {
    if (std::abs(direction[j]) < 1e-3 * direction.cwiseAbs().maxCoeff()) continue;
    text << separator << direction[j] << " " << problem.unknowns[static_cast<std::size_t>(j)].name;
    separator = " + ";
  }
  text << ": moving along it changes no residual";
  return text.str();
}

/// (J'J)^-1 J' by singular values of the column-scaled Jacobian; names what it leaves out.
Eigen::MatrixXd pseudo_inverse(const LeastSquaresProblem& problem,
                               const Minimum& minimum,
                               Uncertainty& result) {
  const auto jacobian = view(minimum.jacobian);
  Eigen::VectorXd scale = jacobian.colwise().norm().transpose();
  for (double& s : scale) s = s > 0.0 ? s : 1.0;
  const Eigen::MatrixXd scaled = jacobian * scale.cwiseInverse().asDiagonal();
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeFullV);
  // Below sqrt(epsilon) of the largest, (J'J) has lost the direction to rounding.
  const double threshold =
      std::sqrt(std::numeric_limits<double>::epsilon()) * svd.singularValues().maxCoeff();
  const Eigen::Index n = scaled.cols();
  result.identifiable.assign(static_cast<std::size_t>(n), true);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(n, scaled.rows());
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd direction = svd.matrixV().col(k).cwiseQuotient(scale);
    if (k < svd.singularValues().size() && svd.singularValues()[k] > threshold) {
      inverse += direction * svd.matrixU().col(k).transpose() / svd.singularValues()[k];
      continue;
    }
    result.null_space.push_back(combination(problem, direction));
    for (Eigen::Index j = 0; j < n; ++j) {
      if (std::abs(svd.matrixV()(j, k)) > 1e-3)
        result.identifiable[static_cast<std::size_t>(j)] = false;
    }
  }
  return inverse;
}

void store_covariance(const Eigen::MatrixXd& factor, Uncertainty& result) {
  const int n = static_cast<int>(factor.rows());
  result.covariance = Matrix(n, n);
  Eigen::Map<RowMajor>(result.covariance.values.data(), n, n) = factor * factor.transpose();
}

}  // namespace

Minimum minimise(const LeastSquaresProblem& problem) {
  Minimum minimum;
  minimum.at_bound.assign(problem.unknowns.size(), false);
  for (const Unknown& unknown : problem.unknowns) minimum.values.push_back(unknown.start);
  while (true) {
    minimise_free(problem, minimum);
    evaluate_at(problem, minimum);
    const int worst = worst_violation(problem, minimum);
    if (worst < 0) return minimum;
    const auto j = static_cast<std::size_t>(worst);
    minimum.at_bound[j] = true;
    minimum.values[j] = problem.unknowns[j].lower;
  }
}

Minimum minimise_reweighted(
    const std::function<LeastSquaresProblem(std::span<const double>)>& problem_at,
    std::vector<double> start) {
  constexpr int most_passes = 50;
  int iterations = 0;
  for (int pass = 1;; ++pass) {
    Minimum minimum = minimise(problem_at(start));
    minimum.iterations = (iterations += minimum.iterations);
    if (!minimum.converged || settled(minimum, start)) return minimum;
    if (pass == most_passes) {
      minimum.converged = false;
      minimum.termination = "the weights still moved the solution after 50 passes";
      return minimum;
    }
    start = minimum.values;
  }
}

Uncertainty uncertainty(const LeastSquaresProblem& problem, const Minimum& minimum) {
  Uncertainty result;
  store_covariance(pseudo_inverse(problem, minimum, result), result);
  return result;
}

Uncertainty uncertainty(const LeastSquaresProblem& problem,
                        const Minimum& minimum,
                        const Matrix& noise) {
  Uncertainty result;
  const Eigen::MatrixXd inverse = pseudo_inverse(problem, minimum, result);
  store_covariance(inverse * view(noise).transpose(), result);
  return result;
}

std::vector<double> correlation(const Matrix& covariance) {
  Matrix result(covariance.rows, covariance.columns);
  for (int i = 0; i < covariance.rows; ++i) {
    for (int j = 0; j < covariance.columns; ++j) {
      const double scale = std::sqrt(covariance(i, i) * covariance(j, j));
      result(i, j) = scale > 0.0 ? covariance(i, j) / scale : 0.0;
    }
  }
  return result.values;
}

FitSummary describe(const std::vector<std::string>& names,
                    const Minimum& minimum,
                    const Uncertainty& uncertainty) {
  FitSummary summary;
  for (std::size_t j = 0; j < names.size(); ++j) {
    const int k = static_cast<int>(j);
    const bool known = uncertainty.identifiable[j];
    summary.coefficients.push_back({.name = names[j],
                                    .value = minimum.values[j],
                                    .error = known ? std::sqrt(uncertainty.covariance(k, k))
                                                   : std::numeric_limits<double>::infinity(),
                                    .at_bound = minimum.at_bound[j],
                                    .identifiable = known});
  }
  summary.correlation = correlation(uncertainty.covariance);
  summary.chi_squared = minimum.chi_squared;
  summary.data = static_cast<int>(minimum.residuals.size());
  summary.iterations = minimum.iterations;
  summary.converged = minimum.converged;
  summary.termination = minimum.termination;
  summary.not_identifiable = uncertainty.null_space;
  return summary;
}

void require_converged(const Minimum& minimum, const std::string& what) {
  if (minimum.converged) return;
  throw FitError("the fit of " + what + " did not converge: " + minimum.termination);
}

}  // namespace grainlaw::calibration
