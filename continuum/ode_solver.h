#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "continuum/answer.h"
#include "continuum/profile.h"

namespace grainlaw::continuum {

/// Writable view of a tridiagonal matrix in column-wise band storage.
class TridiagonalView {
 public:
  TridiagonalView(double* const* columns, long diagonal) : columns_(columns), diagonal_(diagonal) {}
  double& operator()(std::size_t row, std::size_t column) const {
    return columns_[column][static_cast<long>(row) - static_cast<long>(column) + diagonal_];
  }

 private:
  double* const* columns_;
  long diagonal_;  // storage index of the main diagonal
};

/// y' = f(t, y) where f_i depends on y_(i-1), y_i, y_(i+1) only.
class OdeSystem {
 public:
  virtual ~OdeSystem() = default;
  virtual void rate(double t, std::span<const double> y, std::span<double> dydt) const = 0;
  /// df/dy; the matrix arrives filled with zeros.
  virtual void jacobian(double t, std::span<const double> y, TridiagonalView matrix) const = 0;
  /// The solver stops where this changes sign.
  virtual double event(double t, std::span<const double> y) const = 0;
  /// What unknown i is, for error messages.
  virtual std::string component_name(std::size_t i) const = 0;
};

struct OdeOptions {
  double relative_tolerance = 1e-6;
  double absolute_tolerance = 1e-10;
  double end_time = 0.0;  ///< no step goes beyond
  bool stop_at_event = true;
  std::string time_unit{};  ///< follows times in messages
};

/// Stiff integrator: CVODE with BDF, Newton and a direct solve of the band matrix. The system must
/// outlive it.
class OdeSolver {
 public:
  OdeSolver(const OdeSystem& system, std::span<const double> start, const OdeOptions& options);
  ~OdeSolver();
  OdeSolver(const OdeSolver&) = delete;
  OdeSolver& operator=(const OdeSolver&) = delete;

  enum class Step { advanced, event, end };
  /// One internal step. Throws SolverError naming the worst unknown and the time, or what the
  /// system threw.
  Step step();

  /// From now on both tolerances are multiplied by `factor`.
  void tighten(double factor);

  double time() const;
  std::span<const double> state() const;
  /// State at a time inside the last step.
  std::vector<double> interpolate(double time) const;
  SolverStatistics statistics() const;  ///< without wall_seconds

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace grainlaw::continuum
