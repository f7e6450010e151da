#pragma once

#include <optional>
#include <string>

namespace grainlaw::continuum {

/// Grains as the continuum sees them; one consistent set of units.
struct GrainProperties {
  double diameter = 1.0;             ///< d [length]
  double density = 1.0;              ///< rho_p [mass/length^3]
  std::optional<double> stiffness;   ///< k_n [mass/time^2]; absent: rigid grains
  std::optional<double> adhesion;    ///< largest pull f_a [force]; absent: cohesionless
};

/// |tau| - tau_c = a gd^2 + b |gd|  (Brewster et al. 2008, eq. 1). Valid at its own tilt only:
/// for a mu(I) material a = rho_p d^2 tan(theta) / I(theta)^2 is no material constant.
struct GeneralisedBagnold {
  double a = 0.0;        ///< [mass/length]
  double b = 0.0;        ///< [mass/(length time)]
  double tau_c = 0.0;    ///< yield stress [stress]
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
  InertialFriction friction;
  std::optional<SoftnessFriction> softness_friction;
  std::optional<CohesionFriction> cohesion_friction;
  InertialVolumeFraction volume_fraction;
  std::optional<SoftnessVolumeFraction> softness_volume_fraction;
  std::optional<CohesionVolumeFraction> cohesion_volume_fraction;
};

}  // namespace grainlaw::continuum
