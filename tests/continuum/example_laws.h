#pragma once

#include <cmath>
#include <numbers>

#include "continuum/chute_1d.h"

namespace grainlaw::continuum {

inline constexpr double degree = std::numbers::pi / 180.0;

/// mu = mu0 + (mui - mu0) I / (I + I_mu) in the coefficients of the table.
inline InertialFriction saturating_friction(double mu0, double mui, double I_mu) {
  return {.mu0 = mu0, .beta = (mui - mu0) / I_mu, .kappa = 1.0 / I_mu};
}

/// Frictional spheres, mu_p = 0.5, simple shear: Shi et al. 2020, tables 3, 5, 7.
inline MuPhi frictional_spheres() {
  return {.friction = saturating_friction(0.3530, 0.7148, 0.7184),
          .softness_friction = SoftnessFriction{.p_mu = 0.3905},
          .cohesion_friction = CohesionFriction{.alpha = 0.2551, .beta = 1.5125},
          .volume_fraction = {.phi0 = 0.595, .I_phi = 5.383},
          .softness_volume_fraction = SoftnessVolumeFraction{.p_phi = 0.287},
          .cohesion_volume_fraction =
              CohesionVolumeFraction{.p1 = -0.1359, .p2 = 0.0668, .p3 = -0.0162, .p4 = 0.0015}};
}

/// Nearly frictionless spheres, mu_p = 0.01, simple shear, same source.
inline MuPhi slippery_spheres() {
  return {.friction = saturating_friction(0.1645, 0.3499, 0.0818),
          .softness_friction = SoftnessFriction{.p_mu = 0.4950},
          .cohesion_friction = CohesionFriction{.alpha = 0.4490, .beta = 1.5218},
          .volume_fraction = {.phi0 = 0.653, .I_phi = 2.246},
          .softness_volume_fraction = SoftnessVolumeFraction{.p_phi = 0.272},
          .cohesion_volume_fraction =
              CohesionVolumeFraction{.p1 = -0.0237, .p2 = -0.0056, .p3 = 0.0034, .p4 = -0.0004}};
}

/// mu(I) of frictional spheres at constant volume fraction: an exact Bagnold flow.
inline MuPhi incompressible_spheres() {
  return {.friction = saturating_friction(0.3530, 0.7148, 0.7184),
          .volume_fraction = {.phi0 = 0.58, .I_phi = INFINITY}};
}

/// Brewster's law at 24 degrees and phi = 0.58; the stress per depth there.
inline GeneralisedBagnold bagnold_at_24_degrees(double a, double b, double tau_c) {
  return {.a = a, .b = b, .tau_c = tau_c, .volume_fraction = 0.58, .inclination = 24 * degree};
}

template <class Law>
RheologyTable table_of(const Law& law) {
  RheologyTable table;
  table.law = law;
  return table;
}

/// In units d = rho_p = g = 1.
inline ChuteCase chute(double degrees, double mass, GrainProperties grains = {}) {
  return {.inclination = degrees * degree, .mass_per_area = mass, .grains = grains};
}

/// Largest difference of the velocity in the cells (without the rows at base and surface) from
/// `exact`(mass above), relative to the exact surface velocity.
template <class Exact>
double velocity_error(const Profile& profile, Exact exact) {
  double error = 0.0;
  for (std::size_t i = 1; i + 1 < profile.rows.size(); ++i)
    error = std::max(error, std::abs(profile.rows[i].velocity - exact(profile.rows[i].mass_above)));
  return error / exact(0.0);
}

}  // namespace grainlaw::continuum
