#pragma once

#include <cmath>
#include <optional>

namespace grainlaw::continuum {

/// Grains as the continuum sees them; one consistent set of units.
struct GrainProperties {
  double diameter = 1.0;              ///< d [length]
  double density = 1.0;               ///< rho_p [mass/length^3]
  std::optional<double> stiffness{};  ///< k_n [mass/time^2]; absent: rigid grains
  std::optional<double> adhesion{};   ///< largest pull f_a [force]; absent: cohesionless
};

/// |tau| - tau_c = a gd^2 + b |gd|  (Brewster et al. 2008, eq. 1). Valid at its own tilt only:
/// for a mu(I) material a = rho_p d^2 tan(theta) / I(theta)^2 is no material constant.
struct GeneralisedBagnold {
  double a = 0.0;                ///< [mass/length]
  double b = 0.0;                ///< [mass/(length time)]
  double tau_c = 0.0;            ///< yield stress [stress]
  double volume_fraction = 0.0;  ///< phi of the flowing bulk
  double inclination = 0.0;      ///< tilt at which a and b were measured [rad]
};

/// mu(I) = mu0 + beta I / (1 + kappa I). kappa = 0 is the linear law; otherwise
/// mu_inf = mu0 + beta / kappa and I_mu = 1 / kappa  (Shi et al. 2020, eq. 1A).
struct InertialFriction {
  double mu0 = 0.0;
  double beta = 0.0;
  double kappa = 0.0;
};

/// Friction falls with softness: f_p = 1 - sqrt((1 + Bo) p* / p_mu)  (Shi et al. 2020, table 6).
struct SoftnessFriction {
  double p_mu = 0.0;
};

/// Friction rises with cohesion: f_B = 1 + alpha Bo^beta  (Shi et al. 2020, table 6); beyond Bo = 5
/// continued by its tangent, so that the yield stress stays finite at a free surface.
struct CohesionFriction {
  double alpha = 0.0;
  double beta = 1.0;
};

/// phi(I) = phi0 (1 - I / I_phi)  (Shi et al. 2020, eq. 13). I_phi infinite: constant phi.
struct InertialVolumeFraction {
  double phi0 = 0.0;
  double I_phi = 0.0;
};

/// phi rises with pressure: g_p = 1 + (1 + Bo) p* / p_phi  (Shi et al. 2020, eq. 14).
struct SoftnessVolumeFraction {
  double p_phi = 0.0;
};

/// g_c = 1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4  (Shi et al. 2020, eq. 15), held beyond Bo = 5.
struct CohesionVolumeFraction {
  double p1 = 0.0;
  double p2 = 0.0;
  double p3 = 0.0;
  double p4 = 0.0;
};

/// mu(I, p*, Bo) and phi(I, p*, Bo) (Shi et al. 2020, eqs. 16 and 1A). A term that the table does
/// not have is absent, not zero.
struct MuPhi {
  InertialFriction friction{};
  std::optional<SoftnessFriction> softness_friction{};
  std::optional<CohesionFriction> cohesion_friction{};
  InertialVolumeFraction volume_fraction{};
  std::optional<SoftnessVolumeFraction> softness_volume_fraction{};
  std::optional<CohesionVolumeFraction> cohesion_volume_fraction{};
};

/// Beyond this Bond number the cohesion terms are extrapolated with a guard: the quartic of
/// Shi et al. 2020, eq. 15 was fitted up to here and turns negative or explodes soon after.
inline constexpr double largest_fitted_bond_number = 5.0;

// Each law is written once, for coefficients of type S: double in the solver, an automatically
// differentiated number in a fit. Its variable may be of type S or double.

/// tau = tau_c + a gd^2 + b gd for gd >= 0  (Brewster et al. 2008, eq. 1).
template <class S, class T>
S bagnold_shear_stress(const S& a, const S& b, const S& tau_c, const T& shear_rate) {
  return tau_c + (a * shear_rate + b) * shear_rate;
}

/// Inverse of the above: gd at the stress `excess` = |tau| - tau_c; 0 at or below yield. The root
/// is written without the difference of two close numbers, so a = 0 and b = 0 are ordinary values.
template <class S, class T>
S bagnold_shear_rate(const S& a, const S& b, const T& excess) {
  using std::sqrt;
  if (!(excess > 0.0)) return S(0.0);
  return 2.0 * excess / (b + sqrt(b * b + 4.0 * a * excess));
}

/// mu = mu0 + beta I / (1 + kappa I).
template <class S, class T>
S inertial_friction(const S& mu0, const S& beta, const S& kappa, const T& I) {
  return mu0 + beta * I / (1.0 + kappa * I);
}

/// I at which the friction is mu; mu0 <= mu < mu0 + beta / kappa.
template <class S, class T>
S inertial_number_of(const S& mu0, const S& beta, const S& kappa, const T& mu) {
  return (mu - mu0) / (beta - kappa * (mu - mu0));
}

/// f_p = 1 - sqrt(x / p_mu) of the softness x = (1 + Bo) p*.
template <class S, class T>
S softness_friction(const S& p_mu, const T& softness) {
  using std::sqrt;
  if (!(softness > 0.0)) return S(1.0);  // rigid grains exactly; a derivative there is infinite
  return 1.0 - sqrt(softness / p_mu);
}

/// f_B = 1 + alpha Bo^beta up to the largest fitted Bond number, its tangent beyond.
template <class S, class T>
S cohesion_friction(const S& alpha, const S& beta, const T& bond_number) {
  using std::pow;
  if (!(bond_number > 0.0)) return S(1.0);
  if (!(bond_number > largest_fitted_bond_number)) return 1.0 + alpha * pow(bond_number, beta);
  const S edge = S(largest_fitted_bond_number);
  const S at_edge = alpha * pow(edge, beta);
  return 1.0 + at_edge + at_edge * beta / edge * (bond_number - edge);
}

/// phi = phi0 (1 - I / I_phi).
template <class S, class T>
S inertial_volume_fraction(const S& phi0, const S& I_phi, const T& I) {
  return phi0 * (1.0 - I / I_phi);
}

/// g_p = 1 + x / p_phi of the softness x = (1 + Bo) p*.
template <class S, class T>
S softness_volume_fraction(const S& p_phi, const T& softness) {
  return 1.0 + softness / p_phi;
}

/// g_c = 1 + p1 Bo + p2 Bo^2 + p3 Bo^3 + p4 Bo^4, held beyond the largest fitted Bond number.
template <class S, class T>
S cohesion_volume_fraction(
    const S& p1, const S& p2, const S& p3, const S& p4, const T& bond_number) {
  const S Bo =
      bond_number > largest_fitted_bond_number ? S(largest_fitted_bond_number) : S(bond_number);
  return 1.0 + Bo * (p1 + Bo * (p2 + Bo * (p3 + Bo * p4)));
}

/// State of a grain assembly apart from its flow.
struct Confinement {
  double softness = 0.0;     ///< (1 + Bo) p* = (p d + f_a / d) / k_n, finite at a free surface
  double bond_number = 0.0;  ///< Bo = f_a / (p d^2)
};

/// f_p f_B: how much softness and cohesion change the friction. Not positive where softness takes
/// all of it and the law has left physics.
inline double friction_factor(const MuPhi& law, const Confinement& at) {
  const auto& soft = law.softness_friction;
  const auto& cohesive = law.cohesion_friction;
  return (soft ? softness_friction(soft->p_mu, at.softness) : 1.0) *
         (cohesive ? cohesion_friction(cohesive->alpha, cohesive->beta, at.bond_number) : 1.0);
}

/// mu(I, p*, Bo) = mu(I) f_p f_B.
inline double friction(const MuPhi& law, double I, const Confinement& at = {}) {
  return inertial_friction(law.friction.mu0, law.friction.beta, law.friction.kappa, I) *
         friction_factor(law, at);
}

/// phi0 g_p g_c: volume fraction at I -> 0.
inline double static_volume_fraction(const MuPhi& law, const Confinement& at = {}) {
  const auto& soft = law.softness_volume_fraction;
  const auto& c = law.cohesion_volume_fraction;
  return law.volume_fraction.phi0 *
         (soft ? softness_volume_fraction(soft->p_phi, at.softness) : 1.0) *
         (c ? cohesion_volume_fraction(c->p1, c->p2, c->p3, c->p4, at.bond_number) : 1.0);
}

/// phi(I, p*, Bo) = phi0 g_I g_p g_c.
inline double volume_fraction(const MuPhi& law, double I, const Confinement& at = {}) {
  return inertial_volume_fraction(1.0, law.volume_fraction.I_phi, I) *
         static_volume_fraction(law, at);
}

}  // namespace grainlaw::continuum
