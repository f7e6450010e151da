#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "continuum/discrete_layer.h"

namespace grainlaw::continuum {

/// The rigid-viscoplastic layer without any elasticity or regularisation, to check the solver: one
/// implicit Euler step is u' = u + dt (sin(theta) - dsigma/dM) with |du'/dM| = Q(sigma)/K, where
/// Q(sigma) = 0 for |sigma| <= tau_y. Eliminating u' leaves a tridiagonal, strictly monotone system
/// for sigma at the faces, solved by semismooth Newton with a halving line search. First order in
/// dt. For laws that carry every stress.
class ExactYield {
 public:
  explicit ExactYield(DiscreteLayer discrete, Motion start)
      : discrete_(std::move(discrete)),
        velocity_(std::move(start.velocity)),
        stress_(std::move(start.stress)) {}

  void step(double dt) {
    for (int iteration = 0; iteration < 200; ++iteration) {
      const std::vector<double> change = newton_step(dt);
      double share = 1.0;
      const double before = norm(stress_, dt);
      while (share > 1e-6 && norm(moved(change, share), dt) > (1.0 - 1e-4 * share) * before)
        share *= 0.5;
      stress_ = moved(change, share);
      double largest = 0.0;
      for (const double c : change) largest = std::max(largest, std::abs(c));
      if (largest <= 1e-12 * discrete_.layer().mass * discrete_.layer().sine) break;
    }
    velocity_ = velocity_after(stress_, dt);
  }

  const std::vector<double>& velocity() const { return velocity_; }
  double largest_velocity() const {
    double largest = 0.0;
    for (const double u : velocity_) largest = std::max(largest, std::abs(u));
    return largest;
  }
  double largest_rate() const {
    double largest = 0.0;
    for (std::size_t k = 0; k < stress_.size(); ++k)
      largest = std::max(largest, std::abs(rate(stress_[k], k)));
    return largest;
  }

 private:
  double rate(double sigma, std::size_t face) const {
    return std::copysign(*discrete_.curve(face).scaled_rate(std::abs(sigma)), sigma);
  }
  double slope(double sigma, std::size_t face) const {
    const double q = std::abs(rate(sigma, face));
    return q > 0.0 ? 1.0 / discrete_.curve(face).viscous_slope(q) : 0.0;
  }
  std::vector<double> velocity_after(const std::vector<double>& sigma, double dt) const {
    std::vector<double> u = velocity_;
    for (std::size_t k = 0; k < u.size(); ++k)
      u[k] += dt * (discrete_.layer().sine -
                    (sigma[k] - (k > 0 ? sigma[k - 1] : 0.0)) / discrete_.grid().width[k]);
    return u;
  }
  /// Shear of every face by the law minus that of the velocities.
  std::vector<double> mismatch(const std::vector<double>& sigma, double dt) const {
    const std::vector<double> u = velocity_after(sigma, dt);
    std::vector<double> f(u.size());
    for (std::size_t k = 0; k < u.size(); ++k)
      f[k] = rate(sigma[k], k) / discrete_.curve(k).mobility * discrete_.grid().distance[k] -
             (u[k] - (k + 1 < u.size() ? u[k + 1] : 0.0));
    return f;
  }
  double norm(const std::vector<double>& sigma, double dt) const {
    double sum = 0.0;
    for (const double f : mismatch(sigma, dt)) sum += f * f;
    return std::sqrt(sum);
  }
  std::vector<double> moved(const std::vector<double>& change, double share) const {
    std::vector<double> sigma = stress_;
    for (std::size_t k = 0; k < sigma.size(); ++k) sigma[k] += share * change[k];
    return sigma;
  }
  /// Thomas algorithm for the Jacobian of mismatch.
  std::vector<double> newton_step(double dt) const {
    const std::size_t n = stress_.size();
    const auto& width = discrete_.grid().width;
    std::vector<double> x = mismatch(stress_, dt), diagonal(n), upper(n);
    for (std::size_t k = 0; k < n; ++k) {
      const double below = k + 1 < n ? dt / width[k + 1] : 0.0;
      diagonal[k] =
          slope(stress_[k], k) / discrete_.curve(k).mobility * discrete_.grid().distance[k] +
          dt / width[k] + below;
      upper[k] = -below;
      x[k] = -x[k];
      if (k == 0) continue;
      const double factor = -dt / width[k] / diagonal[k - 1];
      diagonal[k] -= factor * upper[k - 1];
      x[k] -= factor * x[k - 1];
    }
    for (std::size_t k = n; k-- > 0;)
      x[k] = (x[k] - (k + 1 < n ? upper[k] * x[k + 1] : 0.0)) / diagonal[k];
    return x;
  }

  DiscreteLayer discrete_;
  std::vector<double> velocity_;
  std::vector<double> stress_;
};

}  // namespace grainlaw::continuum
