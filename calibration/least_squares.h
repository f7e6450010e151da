#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"

namespace grainlaw::calibration {

/// One unknown of a least-squares problem with its physical lower bound.
struct Unknown {
  std::string name;
  double start = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  bool held = false;  ///< stays at its start while the others are minimised
};

/// Dense matrix, row-major.
struct Matrix {
  int rows = 0;
  int columns = 0;
  std::vector<double> values;

  Matrix() = default;
  Matrix(int row_count, int column_count)
      : rows(row_count),
        columns(column_count),
        values(static_cast<std::size_t>(row_count) * static_cast<std::size_t>(column_count)) {}

  double& operator()(int i, int j) { return values[index(i, j)]; }
  double operator()(int i, int j) const { return values[index(i, j)]; }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(j);
  }
};

/// Weighted residuals (model - data) / error at x and, unless `jacobian` is empty, their
/// derivatives [residual][unknown]. Values that are not finite tell the minimiser that the model
/// has none there.
using Residuals =
    std::function<void(std::span<const double> x, std::span<double> r, std::span<double> jacobian)>;

struct LeastSquaresProblem {
  std::vector<Unknown> unknowns;
  int residuals = 0;
  Residuals evaluate;
};

/// Where the sum of squares is smallest within the bounds.
struct Minimum {
  std::vector<double> values;
  std::vector<bool> at_bound;  ///< held at its lower bound: the free minimum lies beyond it
  std::vector<double> residuals;
  Matrix jacobian;  ///< of all unknowns, also of those at their bound
  double chi_squared = 0.0;
  int iterations = 0;
  bool converged = false;
  std::string termination;  ///< of the minimiser, in words
};

/// Levenberg-Marquardt with dense QR on one thread: same input, same bits. The unknowns are first
/// left free, as the laws of granular flow continue smoothly through their bounds; then the one
/// that violates its bound most is held there and the rest is minimised again. So an unknown at its
/// bound still has the derivative that its (one-sided) error needs.
Minimum minimise(const LeastSquaresProblem& problem);

/// Minimises where the weights depend on the solution (effective variance: errors in x times the
/// slope of the law): `problem_at(x)` has the weights of x and starts there. Repeats until the
/// weights no longer move the solution. Weights are held during each pass; if their derivative
/// entered, the sum of squares could be lowered by making the errors larger.
Minimum minimise_reweighted(
    const std::function<LeastSquaresProblem(std::span<const double>)>& problem_at,
    std::vector<double> start);

/// Standard errors of a minimum.
struct Uncertainty {
  Matrix covariance;
  std::vector<bool> identifiable;       ///< false: takes part in a combination without any effect
  std::vector<std::string> null_space;  ///< those combinations in words
};

/// Covariance (J'J)^-1 of a minimum whose weighted residuals are independent with unit variance, by
/// singular values; combinations that change no residual are left out of it and named.
Uncertainty uncertainty(const LeastSquaresProblem& problem, const Minimum& minimum);

/// Sandwich covariance (J'J)^-1 J'S J (J'J)^-1 for weighted residuals with covariance S = sum of
/// l l' over the rows l of `noise` (Huber 1967; White 1980). Right for correlated residuals, where
/// the diagonal weights would promise far too much.
Uncertainty uncertainty(const LeastSquaresProblem& problem,
                        const Minimum& minimum,
                        const Matrix& noise);

/// Correlation matrix of a covariance, row-major; zero where a variance is zero.
std::vector<double> correlation(const Matrix& covariance);

/// Coefficients with errors, correlation and what the minimiser did; an unidentifiable coefficient
/// has an infinite error.
FitSummary describe(const std::vector<std::string>& names,
                    const Minimum& minimum,
                    const Uncertainty& uncertainty);

/// Throws FitError naming `what` was fitted when the minimiser did not converge.
void require_converged(const Minimum& minimum, const std::string& what);

}  // namespace grainlaw::calibration
