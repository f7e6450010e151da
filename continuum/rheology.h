#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "continuum/monotone_curve.h"

namespace grainlaw::continuum {

// Beyond these a law is not that of grains in dense flow, and rates and depths are no numbers that
// mean anything: fits and papers have slopes near 1, exponents of 0.4 to 2 and phi above 0.5.
inline constexpr double steepest_friction = 1e6;         ///< largest beta
inline constexpr double least_exponent = 0.05;           ///< of I in mu(I)
inline constexpr double loosest_volume_fraction = 0.05;  ///< least phi

/// Grains as the continuum sees them; one consistent set of units.
struct GrainProperties {
  double diameter = 1.0;              ///< d [length]
  double density = 1.0;               ///< rho_p [mass/length^3]
  std::optional<double> stiffness{};  ///< k_n [mass/time^2]; absent: rigid grains
  std::optional<double> adhesion{};   ///< largest pull f_a [force]; absent: cohesionless
};

/// |tau| - tau_c = a gd^2 + b |gd|  (Brewster et al. 2008, eq. 1). Valid at its own tilt only:
/// for a mu(I) material a = rho_p d^2 tan(theta) / I(theta)^2 is no material constant, and neither
/// is tau_c = c0 tan(theta) / (tan(theta) - mu0) for grains with the cohesion c0.
struct GeneralisedBagnold {
  double a = 0.0;                ///< [mass/length]
  double b = 0.0;                ///< [mass/(length time)]
  double tau_c = 0.0;            ///< yield stress [stress]
  double volume_fraction = 0.0;  ///< phi of the flowing bulk
  double inclination = 0.0;      ///< tilt at which a and b were measured [rad]
};

/// How friction falls with the softness x = (1 + Bo) p*: f_p = 1 - sqrt(x / p_mu), or 1 - x / p_mu.
enum class SoftnessForm { square_root, linear };

/// Laws with coefficients of type S: double in the solver, an automatically differentiated number
/// in a fit.
namespace laws {

/// mu(I) = mu0 + beta x / (1 + kappa x), x = I^exponent; exponent absent: 1. kappa = 0 is the
/// linear law or the power law; otherwise mu_inf = mu0 + beta / kappa and, with x = I, I_mu = 1 /
/// kappa (Shi et al. 2020, eq. 1A).
template <class S>
struct InertialFriction {
  S mu0{};
  S beta{};
  S kappa{};
  std::optional<S> exponent{};
  std::shared_ptr<const MonotoneCurve> tabulated{};  ///< mu(I) itself, in place of all the others
};

/// Friction falls with softness: f_p = 1 - sqrt((1 + Bo) p* / p_mu)  (Shi et al. 2020, table 6), or
/// without the root.
template <class S>
struct SoftnessFriction {
  S p_mu{};
  SoftnessForm form = SoftnessForm::square_root;
};

/// Friction rises with cohesion: f_B = 1 + alpha Bo^beta  (Shi et al. 2020, table 6); beyond Bo = 5
/// continued by its tangent, so that the yield stress stays finite at a free surface.
template <class S>
struct CohesionFriction {
  S alpha{};
  S beta{1.0};
};

/// Cohesion adds a friction that does not depend on I: mu(I) f_p + factor Bo^b p*^g, in place of
/// CohesionFriction. Without exponents b = 1 and g = 0: a stress that does not depend on pressure,
/// tau = c0 + mu p, c0 = factor f_a / d^2. With them tau_y ~ p^(1 - b + g); beyond Bo = 5 Bo^b goes
/// on along its tangent, so that tau_y stays finite at a free surface: 0 there for g > 0. Rigid
/// grains, p* = 0, lose all cohesion where g > 0.
template <class S>
struct CohesionStress {
  S factor{};
  std::optional<S> bond_exponent{};      ///< b
  std::optional<S> softness_exponent{};  ///< g, at most b and 1: cohesion fades with depth
};

/// phi(I) = phi0 (1 - I / I_phi)  (Shi et al. 2020, eq. 13). I_phi infinite: constant phi.
template <class S>
struct InertialVolumeFraction {
  S phi0{};
  S I_phi{};
};

/// phi rises with pressure: g_p = 1 + (1 + Bo) p* / p_phi  (Shi et al. 2020, eq. 14).
template <class S>
struct SoftnessVolumeFraction {
  S p_phi{};
};

/// g_c = 1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4  (Shi et al. 2020, eq. 15), held beyond Bo = 5.
template <class S>
struct CohesionVolumeFraction {
  S p1{};
  S p2{};
  S p3{};
  S p4{};
};

/// mu(I, p*, Bo) and phi(I, p*, Bo) (Shi et al. 2020, eqs. 16 and 1A) and their relatives. A term
/// that a table does not have is absent, not zero.
template <class S>
struct MuPhi {
  InertialFriction<S> friction{};
  std::optional<SoftnessFriction<S>> softness_friction{};
  std::optional<CohesionFriction<S>> cohesion_friction{};
  InertialVolumeFraction<S> volume_fraction{};
  std::optional<SoftnessVolumeFraction<S>> softness_volume_fraction{};
  std::optional<CohesionVolumeFraction<S>> cohesion_volume_fraction{};
  std::optional<CohesionStress<S>> cohesion_stress{};
};

}  // namespace laws

using InertialFriction = laws::InertialFriction<double>;
using SoftnessFriction = laws::SoftnessFriction<double>;
using CohesionFriction = laws::CohesionFriction<double>;
using CohesionStress = laws::CohesionStress<double>;
using InertialVolumeFraction = laws::InertialVolumeFraction<double>;
using SoftnessVolumeFraction = laws::SoftnessVolumeFraction<double>;
using CohesionVolumeFraction = laws::CohesionVolumeFraction<double>;
using MuPhi = laws::MuPhi<double>;

/// Beyond this Bond number the cohesion terms are extrapolated with a guard: the quartic of
/// Shi et al. 2020, eq. 15 was fitted up to here and turns negative or explodes soon after.
inline constexpr double largest_fitted_bond_number = 5.0;

// Each law is written once, for coefficients of type S and variables of type T; either may carry
// derivatives.

template <class S, class T>
using Mixed = decltype(std::declval<S>() * std::declval<T>());

/// tau = tau_c + a gd^2 + b gd for gd >= 0  (Brewster et al. 2008, eq. 1).
template <class S, class T>
Mixed<S, T> bagnold_shear_stress(const S& a, const S& b, const S& tau_c, const T& shear_rate) {
  return tau_c + (a * shear_rate + b) * shear_rate;
}

/// Inverse of the above: gd at the stress `excess` = |tau| - tau_c; 0 at or below yield. The root
/// is written without the difference of two close numbers, so a = 0 and b = 0 are ordinary values.
template <class S, class T>
Mixed<S, T> bagnold_shear_rate(const S& a, const S& b, const T& excess) {
  using std::sqrt;
  if (!(excess > 0.0)) return Mixed<S, T>(0.0);
  return 2.0 * excess / (b + sqrt(b * b + 4.0 * a * excess));
}

/// mu = mu0 + beta I / (1 + kappa I).
template <class S, class T>
Mixed<S, T> inertial_friction(const S& mu0, const S& beta, const S& kappa, const T& I) {
  return mu0 + beta * I / (1.0 + kappa * I);
}

/// I at which the friction is mu; mu0 <= mu < mu0 + beta / kappa.
template <class S, class T>
Mixed<S, T> inertial_number_of(const S& mu0, const S& beta, const S& kappa, const T& mu) {
  return (mu - mu0) / (beta - kappa * (mu - mu0));
}

/// f_p = 1 - sqrt(x / p_mu) of the softness x = (1 + Bo) p*.
template <class S, class T>
Mixed<S, T> softness_friction(const S& p_mu, const T& softness) {
  using std::sqrt;
  if (!(softness > 0.0)) return Mixed<S, T>(1.0);  // rigid exactly; the slope there is infinite
  return 1.0 - sqrt(softness / p_mu);
}

/// Bo^exponent up to the largest fitted Bond number, its tangent beyond.
template <class S, class T>
Mixed<S, T> guarded_power(const T& bond_number, const S& exponent) {
  using std::pow;
  if (!(bond_number > 0.0)) return Mixed<S, T>(0.0);
  if (!(bond_number > largest_fitted_bond_number)) return pow(bond_number, exponent);
  const S edge = S(largest_fitted_bond_number);
  const S at_edge = pow(edge, exponent);
  return at_edge + at_edge * exponent / edge * (bond_number - edge);
}

/// f_B = 1 + alpha Bo^beta, guarded.
template <class S, class T>
Mixed<S, T> cohesion_friction(const S& alpha, const S& beta, const T& bond_number) {
  return 1.0 + alpha * guarded_power(bond_number, beta);
}

/// phi = phi0 (1 - I / I_phi).
template <class S, class T>
Mixed<S, T> inertial_volume_fraction(const S& phi0, const S& I_phi, const T& I) {
  return phi0 * (1.0 - I / I_phi);
}

/// g_p = 1 + x / p_phi of the softness x = (1 + Bo) p*.
template <class S, class T>
Mixed<S, T> softness_volume_fraction(const S& p_phi, const T& softness) {
  return 1.0 + softness / p_phi;
}

/// g_c = 1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4, held beyond the largest fitted Bond number.
template <class S, class T>
Mixed<S, T> cohesion_volume_fraction(
    const S& p1, const S& p2, const S& p3, const S& p4, const T& bond_number) {
  const T Bo =
      bond_number > largest_fitted_bond_number ? T(largest_fitted_bond_number) : bond_number;
  return 1.0 + Bo * (p1 + Bo * (p2 + Bo * (p3 + Bo * p4)));
}

/// State of a grain assembly apart from its flow.
template <class T>
struct ConfinementOf {
  T softness{};     ///< (1 + Bo) p* = (p d + f_a / d) / k_n, finite at a free surface
  T bond_number{};  ///< Bo = f_a / (p d^2)
};
using Confinement = ConfinementOf<double>;

/// (1 + Bo) p* and Bo of grains under the pressure p.
template <class T>
ConfinementOf<T> confinement(const GrainProperties& grains, const T& pressure) {
  const double d = grains.diameter;
  const double adhesion = grains.adhesion.value_or(0.0);
  return {.softness = grains.stiffness ? (pressure * d + adhesion / d) / *grains.stiffness : T(0.0),
          .bond_number = adhesion > 0.0 ? adhesion / (pressure * d * d) : T(0.0)};
}

/// mu(I) without softness and cohesion.
template <class S, class T>
Mixed<S, T> friction(const laws::InertialFriction<S>& law, const T& I) {
  using std::pow;
  if (law.tabulated) return Mixed<S, T>((*law.tabulated)(I));
  if (!law.exponent) return inertial_friction(law.mu0, law.beta, law.kappa, I);
  if (!(I > 0.0)) return Mixed<S, T>(law.mu0);
  return inertial_friction(law.mu0, law.beta, law.kappa, pow(I, *law.exponent));
}

/// I at which mu(I) is mu; not positive at or below mu0. Of a tabulated law, which has numbers
/// only, the last I above its range.
template <class S, class T>
Mixed<S, T> inertial_number_of(const laws::InertialFriction<S>& law, const T& mu) {
  using std::pow;
  if constexpr (std::is_same_v<Mixed<S, T>, double>)
    if (law.tabulated) return law.tabulated->inverse(mu).value_or(law.tabulated->x().back());
  const Mixed<S, T> x = inertial_number_of(law.mu0, law.beta, law.kappa, mu);
  return law.exponent && x > 0.0 ? pow(x, 1.0 / *law.exponent) : x;
}

/// f_p: 1 where the law has no such term. Not positive where softness takes all friction and the
/// law has left physics.
template <class S, class T>
Mixed<S, T> softness_factor(const laws::MuPhi<S>& law, const ConfinementOf<T>& at) {
  const auto& soft = law.softness_friction;
  if (!soft) return Mixed<S, T>(1.0);
  if (soft->form == SoftnessForm::linear) return 1.0 - at.softness / soft->p_mu;
  return softness_friction(soft->p_mu, at.softness);
}

/// f_p f_B: how much softness and cohesion change the friction.
template <class S, class T = double>
Mixed<S, T> friction_factor(const laws::MuPhi<S>& law, const ConfinementOf<T>& at) {
  const auto& cohesive = law.cohesion_friction;
  const Mixed<S, T> soft = softness_factor(law, at);
  return cohesive ? soft * cohesion_friction(cohesive->alpha, cohesive->beta, at.bond_number)
                  : soft;
}

/// factor Bo^b p*^g.
template <class S, class T = double>
Mixed<S, T> cohesion_friction(const laws::CohesionStress<S>& law, const ConfinementOf<T>& at) {
  using std::pow;
  using Number = Mixed<S, T>;
  if (!(at.bond_number > 0.0)) return Number(0.0);
  const Number mu =
      law.factor * (law.bond_exponent ? guarded_power(at.bond_number, *law.bond_exponent)
                                      : Number(at.bond_number));
  if (!law.softness_exponent) return mu;
  const T softness = at.softness / (1.0 + at.bond_number);  // p*
  if (softness > 0.0) return mu * pow(softness, *law.softness_exponent);
  return *law.softness_exponent > 0.0 ? Number(0.0) : mu;
}

/// mu(I, p*, Bo) = mu(I) f_p f_B, or mu(I) f_p + factor Bo^b p*^g.
template <class S, class T = double>
Mixed<S, T> friction(const laws::MuPhi<S>& law, const T& I, const ConfinementOf<T>& at = {}) {
  const Mixed<S, T> mu = friction(law.friction, I) * friction_factor(law, at);
  return law.cohesion_stress ? mu + cohesion_friction(*law.cohesion_stress, at) : mu;
}

/// phi0 g_p g_c: volume fraction at I -> 0.
template <class S, class T = double>
Mixed<S, T> static_volume_fraction(const laws::MuPhi<S>& law, const ConfinementOf<T>& at = {}) {
  const auto& soft = law.softness_volume_fraction;
  const auto& c = law.cohesion_volume_fraction;
  Mixed<S, T> phi(law.volume_fraction.phi0);
  if (soft) phi = phi * softness_volume_fraction(soft->p_phi, at.softness);
  if (c) phi = phi * cohesion_volume_fraction(c->p1, c->p2, c->p3, c->p4, at.bond_number);
  return phi;
}

/// phi(I, p*, Bo) = phi0 g_I g_p g_c.
template <class S, class T = double>
Mixed<S, T> volume_fraction(const laws::MuPhi<S>& law,
                            const T& I,
                            const ConfinementOf<T>& at = {}) {
  return inertial_volume_fraction(S(1.0), law.volume_fraction.I_phi, I) *
         static_volume_fraction(law, at);
}

/// tau(gd, p) of flowing grains, gd > 0.
template <class T>
T shear_stress(const MuPhi& law, const GrainProperties& grains, const T& shear_rate, const T& p) {
  using std::sqrt;
  const T I = shear_rate * grains.diameter * sqrt(grains.density / p);
  return p * friction(law, I, confinement(grains, p));
}
template <class T>
T shear_stress(const GeneralisedBagnold& law,
               const GrainProperties&,
               const T& shear_rate,
               const T&) {
  return bagnold_shear_stress(law.a, law.b, law.tau_c, shear_rate);
}

}  // namespace grainlaw::continuum
