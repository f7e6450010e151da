#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/contact.h"

namespace grainlaw::dem {

/// Linear spring and dashpot, f = k overlap - gamma m_ij v_n  (Brewster et al. 2008, eq. 2 with
/// f(x) = 1). Not clipped: the end of a contact attracts, as their eq. 7 assumes.
struct Hooke {
  static constexpr std::string_view name = "hooke";
  double stiffness = 0.0;  ///< k_n [mass/time^2]
  double damping = 0.0;    ///< gamma_n [1/time], times the reduced mass

  double force(const Contact& c) const {
    return stiffness * c.overlap - damping * c.reduced_mass * c.normal_velocity;
  }
  double elastic_energy(const Contact& c) const { return 0.5 * stiffness * c.overlap * c.overlap; }
  double dissipated_power(const Contact& c) const {
    return damping * c.reduced_mass * c.normal_velocity * c.normal_velocity;
  }

  /// Duration of a collision without damping, pi sqrt(m_ij / k) [time].
  double contact_time(double reduced_mass) const {
    return std::numbers::pi * std::sqrt(reduced_mass / stiffness);
  }
  /// Duration of a collision with damping (Brewster eq. 8) [time].
  double collision_time(double reduced_mass) const {
    return std::numbers::pi / std::sqrt(stiffness / reduced_mass - 0.25 * damping * damping);
  }
  /// Normal restitution (Brewster eq. 7).
  double restitution(double reduced_mass) const {
    return std::exp(-0.5 * damping * collision_time(reduced_mass));
  }
};

/// gamma_n [1/time] that gives the wanted restitution (Brewster eqs. 7 and 8 inverted).
inline double damping_for(double restitution, double stiffness, double reduced_mass) {
  const double loss = -std::log(restitution);
  const double ratio = loss / std::hypot(std::numbers::pi, loss);
  return 2.0 * ratio * std::sqrt(stiffness / reduced_mass);
}

}  // namespace grainlaw::dem
