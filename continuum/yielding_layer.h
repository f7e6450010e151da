#pragma once

#include "continuum/transient_system.h"
#include "continuum/yielding_curve.h"

namespace grainlaw::continuum {

/// Elasto-viscoplastic layer: below yield it strains elastically, so that a plug, an arrest in
/// finite time and rest are exact without any regularised yield stress. Unknowns are the velocity
/// of every cell and the stress sigma at its lower face:
///     du/dt     = sin(theta) - d(sigma + t_e dsigma/dt)/dM
///     dsigma/dt = G (K |du/dM| - Q(sigma)),     Q(sigma) = 0 for |sigma| <= tau_y.
/// The steady state depends neither on G nor on t_e. Both follow from one time: G lets the slowest
/// elastic wave cross the layer in about t_e, and t_e makes that wave critically damped and every
/// other one overdamped, so stresses follow the rigid material within a few t_e without ringing.
class YieldingLayer : public TransientSystem {
 public:
  YieldingLayer(DiscreteLayer discrete, double elastic_time);

  Bandwidth bandwidth() const override { return {2, 2}; }
  void rate(double t, std::span<const double> y, std::span<double> dydt) const override;
  void jacobian(double t, std::span<const double> y, BandView matrix) const override;
  double event(double t, std::span<const double> y) const override;
  std::size_t event_count() const override { return 2; }
  void events(double t, std::span<const double> y, std::span<double> values) const override;
  std::string component_name(std::size_t i) const override;

  std::vector<double> state(const Motion& motion) const override;
  Motion motion(std::span<const double> state) const override;
  double mean_velocity(std::span<const double> y) const override;
  /// The rate of the velocity itself: that of the stress differences is noise times G.
  double acceleration(std::span<const double> state,
                      std::span<const double> rate,
                      std::size_t cell) const override;

  double elastic_time() const { return elastic_time_; }
  double modulus(std::size_t face) const { return wave_speed_squared_ / curve(face).mobility; }

 private:
  /// Rate of the stress below a cell.
  double stress_rate(std::span<const double> y, std::size_t face) const;
  /// Of side walls on a cell: all of it, against the motion, and its slope by the velocity (without
  /// that of the volume fraction).
  double wall_friction(std::span<const double> y, std::size_t cell) const;
  double wall_deceleration(std::span<const double> y, std::size_t cell) const;
  double wall_slope(std::span<const double> y, std::size_t cell) const;
  double plastic_rate(double stress, std::size_t face) const;

  double elastic_time_;
  double wave_speed_squared_;            // G K, in the mass coordinate
  std::vector<YieldingCurve> yielding_;  // at the lower face of every cell
};

}  // namespace grainlaw::continuum
