#pragma once

#include "continuum/transient_system.h"

namespace grainlaw::continuum {

/// Layer whose faces all shear forwards, with the scaled shear rate q as the state, since a
/// tolerance on u would let noise set the shear rate near the surface:
///     dq_k/dt = K_k (acceleration above - acceleration below) / distance_k.
/// Unknown k belongs to the lower face of cell k; the base has u = 0. delta = 0 keeps tau(q -> 0+)
/// = tau_y. A slip length lies in series with the lowest half cell; in the Jacobian its dependence
/// on dilation is left out. With delta > 0 the yield stress is multiplied by q / sqrt(q^2 +
/// delta^2)  (Bercovier and Engelman 1980), kept to study the error of that.
class ShearLayer : public TransientSystem {
 public:
  ShearLayer(DiscreteLayer discrete, double delta);

  void rate(double t, std::span<const double> q, std::span<double> dqdt) const override;
  void jacobian(double t, std::span<const double> q, BandView matrix) const override;
  double event(double t, std::span<const double> q) const override;
  std::string component_name(std::size_t i) const override;

  std::vector<double> state(const Motion& motion) const override;
  Motion motion(std::span<const double> q) const override;
  double mean_velocity(std::span<const double> q) const override;
  /// From the stresses of q: the rates of q say less.
  double acceleration(std::span<const double> q,
                      std::span<const double> rate,
                      std::size_t cell) const override;

 private:
  double stress(std::size_t face, double q) const;
  double slope(std::size_t face, double q) const;

  double delta_;
};

}  // namespace grainlaw::continuum
