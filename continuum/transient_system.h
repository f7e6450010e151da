#pragma once

#include "continuum/discrete_layer.h"
#include "continuum/ode_solver.h"

namespace grainlaw::continuum {

/// Momentum balance of a layer as a system for CVODE, du/dt = sin(theta) - dtau/dM in units
/// d = rho_p = g = 1; what the unknowns are is a choice of the system.
class TransientSystem : public OdeSystem {
 public:
  enum Event : std::size_t {
    dense_event,  ///< I rises through I_phi (1 - 1e-3)
    yield_event,  ///< rising: the first face yields; falling: the last one stops (if it can)
  };

  /// Share of I_phi at which the dense state counts as lost.
  static constexpr double dense_share = 1.0 - 1e-3;

  virtual std::vector<double> state(const Motion& motion) const = 0;
  virtual Motion motion(std::span<const double> state) const = 0;
  /// du/dt of a cell, from the unknowns and their rates of change.
  virtual double acceleration(std::span<const double> state,
                              std::span<const double> rate,
                              std::size_t cell) const = 0;
  virtual double mean_velocity(std::span<const double> state) const = 0;  ///< of the mass
  /// max |du/dt| over the cells.
  double largest_acceleration(std::span<const double> state, std::span<const double> rate) const;

  const DiscreteLayer& discrete() const { return discrete_; }

 protected:
  explicit TransientSystem(DiscreteLayer discrete) : discrete_(std::move(discrete)) {}
  std::size_t cells() const { return discrete_.cells(); }
  const MassGrid& grid() const { return discrete_.grid(); }
  const FlowCurve& curve(std::size_t face) const { return discrete_.curve(face); }
  double drive() const { return discrete_.layer().sine; }
  std::string face_name(std::size_t face) const;

 private:
  DiscreteLayer discrete_;
};

}  // namespace grainlaw::continuum
