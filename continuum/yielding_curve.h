#pragma once

#include <cmath>

#include "continuum/flow_curve.h"
#include "continuum/ode_solver.h"

namespace grainlaw::continuum {

/// The rate q(sigma) of a flow curve for stresses of either sign, 0 up to yield, as an implicit
/// integrator can use it. Where b = 0, or where stress rises with a power of I above 1, dq/dsigma
/// is infinite at yield, which no Newton iteration stands: up to a small stress above yield the
/// secant stands in there.
class YieldingCurve {
 public:
  /// Share of the driving stress above yield that the secant spans. Of the steady velocity that
  /// takes at most a quarter of its 3/2 power, 2.5e-7 (b = 0; less for powers below 2).
  static constexpr double secant_share = 1e-4;

  YieldingCurve(const FlowCurve& curve, double driving_stress) : curve_(curve) {
    if (curve.quadratic <= 0.0 && curve.exponent <= 1.0) return;
    secant_ = secant_share * driving_stress;
    secant_slope_ = curve.scaled_rate(curve.yield_stress + secant_).value_or(0.0) / secant_;
  }

  /// Throws StateError where the law cannot carry the stress.
  double rate(double stress) const {
    const double excess = std::abs(stress) - curve_.yield_stress;
    if (excess <= 0.0) return 0.0;
    if (excess < secant_) return std::copysign(excess * secant_slope_, stress);
    const auto q = curve_.scaled_rate(std::abs(stress));
    if (!q) throw StateError("exceeds what the law can carry");
    return std::copysign(*q, stress);
  }
  double slope(double stress) const {
    const double excess = std::abs(stress) - curve_.yield_stress;
    if (excess <= 0.0) return 0.0;
    if (excess < secant_) return secant_slope_;
    return 1.0 / curve_.viscous_slope(std::abs(rate(stress)));
  }

 private:
  FlowCurve curve_;
  double secant_ = 0.0;
  double secant_slope_ = 0.0;
};

}  // namespace grainlaw::continuum
