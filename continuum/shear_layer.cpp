#include "continuum/shear_layer.h"

#include <cmath>

namespace grainlaw::continuum {

ShearLayer::ShearLayer(DiscreteLayer discrete, double delta)
    : TransientSystem(std::move(discrete)), delta_(delta) {}

double ShearLayer::stress(std::size_t face, double q) const {
  const double yielded = delta_ == 0.0 ? 1.0 : q / std::sqrt(q * q + delta_ * delta_);
  return curve(face).yield_stress * yielded + curve(face).viscous_stress(q);
}

double ShearLayer::slope(std::size_t face, double q) const {
  const double size = std::sqrt(q * q + delta_ * delta_);
  const double yielding = delta_ == 0.0 ? 0.0 : (delta_ / size) * (delta_ / size) / size;
  return curve(face).yield_stress * yielding + curve(face).viscous_slope(q);
}

double ShearLayer::mean_velocity(std::span<const double> q) const {
  double momentum = 0.0;  // int u dM = int M |du/dM| dM by parts
  for (std::size_t k = 0; k < cells(); ++k)
    momentum += q[k] / curve(k).mobility * grid().distance[k] * grid().face[k];
  return momentum / discrete().layer().mass;
}

double ShearLayer::acceleration(std::span<const double> q,
                                std::span<const double>,
                                std::size_t cell) const {
  const double above = cell == 0 ? 0.0 : stress(cell - 1, q[cell - 1]);
  return drive() - (stress(cell, q[cell]) - above) / grid().width[cell];
}

void ShearLayer::rate(double, std::span<const double> q, std::span<double> dqdt) const {
  double stress_above = 0.0;
  double acceleration_above = 0.0;
  for (std::size_t k = 0; k < cells(); ++k) {
    const double stress_below = stress(k, q[k]);
    const double here = drive() - (stress_below - stress_above) / grid().width[k];
    if (k > 0)
      dqdt[k - 1] = curve(k - 1).mobility * (acceleration_above - here) / grid().distance[k - 1];
    stress_above = stress_below;
    acceleration_above = here;
  }
  dqdt.back() = acceleration_above / discrete().base_velocity_slope(q.back());
}

void ShearLayer::jacobian(double, std::span<const double> q, BandView matrix) const {
  const auto factor = [&](std::size_t k) {
    return k + 1 < cells() ? curve(k).mobility / grid().distance[k]
                           : 1.0 / discrete().base_velocity_slope(q[k]);
  };
  for (std::size_t k = 0; k < cells(); ++k) {
    const double stiffness = slope(k, q[k]);  // d tau_k / d q_k: drags the cell above, drives below
    const double above = stiffness / grid().width[k];
    const double below = k + 1 < cells() ? stiffness / grid().width[k + 1] : 0.0;
    if (k > 0) matrix(k - 1, k) = factor(k - 1) * above;
    matrix(k, k) = -factor(k) * (above + below);
    if (k + 1 < cells()) matrix(k + 1, k) = factor(k + 1) * below;
  }
}

double ShearLayer::event(double, std::span<const double> q) const {
  const double I_phi = curve(cells() - 1).I_phi;
  if (std::isinf(I_phi)) return -1.0;
  return discrete().largest_inertial_number(q) / I_phi - dense_share;
}

std::string ShearLayer::component_name(std::size_t i) const {
  return "the scaled shear rate at " + face_name(i);
}

std::vector<double> ShearLayer::state(const Motion& motion) const {
  std::vector<double> q(cells());
  for (std::size_t k = 0; k < cells(); ++k) {
    q[k] = k + 1 < cells() ? curve(k).mobility * (motion.velocity[k] - motion.velocity[k + 1]) /
                                 grid().distance[k]
                           : discrete().base_rate(motion.velocity[k]);
  }
  return q;
}

Motion ShearLayer::motion(std::span<const double> q) const {
  Motion motion{.velocity = discrete().velocity(q), .rate = {q.begin(), q.end()}, .stress = {}};
  for (std::size_t k = 0; k < cells(); ++k) motion.stress.push_back(stress(k, q[k]));
  return motion;
}

}  // namespace grainlaw::continuum
