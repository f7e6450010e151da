#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "continuum/answer.h"
#include "continuum/profile.h"

namespace grainlaw::continuum {

/// Writable view of a band matrix in column-wise storage.
class BandView {
 public:
  BandView(double* const* columns, long diagonal) : columns_(columns), diagonal_(diagonal) {}
  double& operator()(std::size_t row, std::size_t column) const {
    return columns_[column][static_cast<long>(row) - static_cast<long>(column) + diagonal_];
  }

 private:
  double* const* columns_;
  long diagonal_;  // storage index of the main diagonal
};
using TridiagonalView = BandView;  ///< of systems with one neighbour on either side

/// How many diagonals below and above the main one a Jacobian has.
struct Bandwidth {
  long lower = 1;
  long upper = 1;
};

/// y' = f(t, y) where f_i depends on near neighbours of y_i only.
class OdeSystem {
 public:
  virtual ~OdeSystem() = default;
  virtual Bandwidth bandwidth() const { return {}; }
  /// May throw StateError: the solver then tries a smaller step.
  virtual void rate(double t, std::span<const double> y, std::span<double> dydt) const = 0;
  /// df/dy; the matrix arrives filled with zeros.
  virtual void jacobian(double t, std::span<const double> y, BandView matrix) const = 0;
  /// The solver stops where this changes sign.
  virtual double event(double t, std::span<const double> y) const = 0;
  /// The same for several events at once.
  virtual std::size_t event_count() const { return 1; }
  virtual void events(double t, std::span<const double> y, std::span<double> values) const {
    values[0] = event(t, y);
  }
  /// What unknown i is, for error messages.
  virtual std::string component_name(std::size_t i) const = 0;
};

/// The equations have no value at the state that was tried.
struct StateError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One root of a system: which of its events, and the sign of the change.
struct OdeEvent {
  std::size_t index = 0;
  bool rising = false;
};

struct OdeOptions {
  double relative_tolerance = 1e-6;
  double absolute_tolerance = 1e-10;
  double start_time = 0.0;
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
  /// What happened when step() returned event; the first one of several at once.
  OdeEvent event() const;

  /// From now on both tolerances are multiplied by `factor`.
  void tighten(double factor);

  double time() const;
  std::span<const double> state() const;
  /// dy/dt of the interpolating polynomial at the end of the last step: free of the noise that f(y)
  /// of a stiff system makes of the remaining error of Newton's iteration.
  std::vector<double> derivative() const;
  /// State at a time inside the last step.
  std::vector<double> interpolate(double time) const;
  SolverStatistics statistics() const;  ///< without wall_seconds

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace grainlaw::continuum
