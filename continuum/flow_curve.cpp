#include "continuum/flow_curve.h"

#include <cmath>

namespace grainlaw::continuum {

double FlowCurve::viscous_stress(double q) const {
  const double size = std::abs(q);
  return q * (linear + quadratic * size) / (1.0 + saturation() * size);
}

double FlowCurve::viscous_slope(double q) const {
  const double size = std::abs(q);
  const double k = saturation();
  const double denominator = 1.0 + k * size;
  return (linear + (2.0 + k * size) * quadratic * size) / (denominator * denominator);
}

std::optional<double> FlowCurve::scaled_rate(double tau) const {
  const double excess = tau - yield_stress;
  if (excess <= 0.0) return 0.0;
  const double b = linear - saturation() * excess;  // a q^2 + (b - k t) q = t
  if (quadratic == 0.0 && b <= 0.0) return std::nullopt;
  return bagnold_shear_rate(quadratic, b, excess);
}

std::optional<double> FlowCurve::relative_inertial_number(double tau) const {
  const double excess = tau - yield_stress;
  if (excess <= 0.0) return 0.0;
  const double b = linear - kappa * excess;
  if (quadratic == 0.0 && b <= 0.0) return std::nullopt;
  return bagnold_shear_rate(quadratic, b, excess) / I_phi;
}

Confinement confinement(const GrainProperties& grains, double pressure) {
  const double adhesion = grains.adhesion.value_or(0.0);
  return {.softness = grains.stiffness ? (pressure + adhesion) / *grains.stiffness : 0.0,
          .bond_number = adhesion > 0.0 ? adhesion / pressure : 0.0};
}

FlowCurve flow_curve(const GeneralisedBagnold& law, const GrainProperties&, double) {
  return {.mobility = law.volume_fraction,
          .yield_stress = law.tau_c,
          .linear = law.b,
          .quadratic = law.a,
          .static_volume_fraction = law.volume_fraction};
}

FlowCurve flow_curve(const MuPhi& law, const GrainProperties& grains, double pressure) {
  const Confinement at = confinement(grains, pressure);
  const double friction_scale = pressure * friction_factor(law, at);
  const double phi = static_volume_fraction(law, at);
  return {.mobility = phi / std::sqrt(pressure),
          .yield_stress = friction_scale * law.friction.mu0,
          .linear = friction_scale * law.friction.beta,
          .kappa = law.friction.kappa,
          .I_phi = law.volume_fraction.I_phi,
          .static_volume_fraction = phi};
}

}  // namespace grainlaw::continuum
