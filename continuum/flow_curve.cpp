#include "continuum/flow_curve.h"

#include <cmath>

#include "continuum/dual.h"

namespace grainlaw::continuum {
namespace {

LocalFlow invert(const FlowCurve& curve, double tau, double pressure) {
  LocalFlow flow{.volume_fraction = curve.static_volume_fraction};
  if (tau <= curve.yield_stress) return flow;
  const auto relative_I = curve.relative_inertial_number(tau);
  if (!relative_I) return {.state = LocalState::no_steady};
  const auto q = curve.scaled_rate(tau);
  if (*relative_I >= 1.0 || !q)
    return {.state = LocalState::no_dense_state, .inertial_number = *relative_I * curve.I_phi};
  flow.state = LocalState::flows;
  flow.shear_rate = curve.shear_rate(*q);
  flow.inertial_number = flow.shear_rate / std::sqrt(pressure);
  flow.volume_fraction = curve.volume_fraction(*q);
  return flow;
}

template <class Law>
StressResponse response(const Law& law,
                        const GrainProperties& grains,
                        double shear_rate,
                        double pressure) {
  using Number = Dual<2>;
  const Number tau =
      shear_stress(law, grains, Number::variable(shear_rate, 0), Number::variable(pressure, 1));
  return {tau.value, tau.slope[0], tau.slope[1]};
}

}  // namespace

double FlowCurve::variable(double I) const {
  return tabulated ? (*tabulated)(I)-tabulated->y().front() : std::pow(I, exponent);
}

double FlowCurve::variable_slope(double I) const {
  return tabulated ? tabulated->slope(I) : exponent * std::pow(I, exponent) / I;
}

double FlowCurve::largest_stress() const {
  if (tabulated) return yield_stress + linear * (tabulated->y().back() - tabulated->y().front());
  if (quadratic > 0.0) return std::numeric_limits<double>::infinity();
  return yield_stress + (linear > 0.0 ? linear / kappa : 0.0);  // Coulomb: none
}

double FlowCurve::viscous_stress(double q) const {
  const double size = std::abs(q);
  if (rational()) return q * (linear + quadratic * size) / (1.0 + saturation() * size);
  const double x = variable(size / (1.0 + size / I_phi));
  return std::copysign(linear * x / (1.0 + kappa * x), q);
}

double FlowCurve::viscous_slope(double q) const {
  const double size = std::abs(q);
  if (rational()) {
    const double denominator = 1.0 + saturation() * size;
    return (linear + (2.0 + saturation() * size) * quadratic * size) / (denominator * denominator);
  }
  const double dilated = 1.0 + size / I_phi;  // I = q / dilated, dI/dq = 1 / dilated^2
  const double saturated = 1.0 + kappa * variable(size / dilated);
  return linear * variable_slope(size / dilated) / (dilated * dilated * saturated * saturated);
}

std::optional<double> FlowCurve::inertial_number(double tau) const {
  const double excess = tau - yield_stress;
  if (excess <= 0.0) return 0.0;
  const double b = linear - kappa * excess;
  if (quadratic == 0.0 && b <= 0.0) return std::nullopt;
  const double x = bagnold_shear_rate(quadratic, b, excess);
  if (tabulated) return tabulated->inverse(x + tabulated->y().front());
  return exponent == 1.0 ? x : std::pow(x, 1.0 / exponent);
}

std::optional<double> FlowCurve::scaled_rate(double tau) const {
  if (!rational()) {
    const auto I = inertial_number(tau);
    if (!I || *I >= I_phi) return std::nullopt;
    return *I / (1.0 - *I / I_phi);
  }
  const double excess = tau - yield_stress;
  if (excess <= 0.0) return 0.0;
  const double b = linear - saturation() * excess;  // a q^2 + (b - k t) q = t
  if (quadratic == 0.0 && b <= 0.0) return std::nullopt;
  return bagnold_shear_rate(quadratic, b, excess);
}

std::optional<double> FlowCurve::relative_inertial_number(double tau) const {
  const auto I = inertial_number(tau);
  if (!I) return std::nullopt;
  return *I / I_phi;
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
  const MonotoneCurve* curve = law.friction.tabulated.get();
  const double cohesion =
      law.cohesion_stress ? pressure * cohesion_friction(*law.cohesion_stress, at) : 0.0;
  return {.mobility = phi / std::sqrt(pressure),
          .yield_stress = friction_scale * friction(law.friction, 0.0) + cohesion,
          .linear = friction_scale * (curve ? 1.0 : law.friction.beta),
          .kappa = curve ? 0.0 : law.friction.kappa,
          .exponent = law.friction.exponent.value_or(1.0),
          .tabulated = curve,
          .I_phi = law.volume_fraction.I_phi,
          .static_volume_fraction = phi};
}

std::string_view name(LocalState state) {
  switch (state) {
    case LocalState::rests:
      return "rests";
    case LocalState::flows:
      return "flows";
    case LocalState::no_steady:
      return "no steady flow";
    case LocalState::no_dense_state:
      return "no dense state";
    case LocalState::no_friction:
      break;
  }
  return "no friction";
}

LocalFlow local_flow(const GeneralisedBagnold& law,
                     const GrainProperties& grains,
                     double tau,
                     double pressure) {
  return invert(flow_curve(law, grains, pressure), tau, pressure);
}

LocalFlow local_flow(const MuPhi& law, const GrainProperties& grains, double tau, double pressure) {
  if (softness_factor(law, confinement(grains, pressure)) <= 0.0)
    return {.state = LocalState::no_friction};
  return invert(flow_curve(law, grains, pressure), tau, pressure);
}

StressResponse stress_response(const GeneralisedBagnold& law,
                               const GrainProperties& grains,
                               double shear_rate,
                               double pressure) {
  return response(law, grains, shear_rate, pressure);
}

StressResponse stress_response(const MuPhi& law,
                               const GrainProperties& grains,
                               double shear_rate,
                               double pressure) {
  return response(law, grains, shear_rate, pressure);
}

}  // namespace grainlaw::continuum
