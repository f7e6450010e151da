#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/contact.h"

namespace grainlaw::dem {

/// The viscosity of a pair, by any of the three ways to state dissipation [mass/time].
template <class Law, class S>
[[gnu::always_inline]] inline S viscosity(const Law& law, const S& reduced_mass) {
  S result = law.damping * reduced_mass + law.dashpot;
  if (law.root_damping > 0.0) result += law.root_damping * sqrt(reduced_mass);
  return result;
}

/// Linear spring and dashpot, f = k overlap - gamma m_ij v_n  (Brewster et al. 2008, eq. 2 with
/// f(x) = 1; Shi et al. 2020, eq. 2). Not clipped unless asked: the end of a contact attracts, as
/// eq. 7 of Brewster et al. assumes.
struct Hooke {
  static constexpr std::string_view name = "hooke";
  static constexpr bool constant_prefactor = true;
  double stiffness = 0.0;        ///< k_n [mass/time^2]
  double damping = 0.0;          ///< gamma_n [1/time], times the reduced mass
  bool clip_attraction = false;  ///< no negative force between touching grains
  double dashpot = 0.0;          ///< gamma_n [mass/time], the same for all pairs
  double root_damping =
      0.0;  ///< [sqrt(mass)/time], times sqrt(m_ij): one restitution for all pairs

  template <class S>
  [[gnu::always_inline]] S elastic_force(const ContactOf<S>& c) const {
    return stiffness * c.overlap;
  }
  /// Of touching grains [force].
  template <class S>
  [[gnu::always_inline]] S force(const ContactOf<S>& c) const {
    const S total = elastic_force(c) - viscosity(*this, c.reduced_mass) * c.normal_velocity;
    return clip_attraction ? max(total, S(0.0)) : total;
  }
  /// f(x) of Brewster et al., by which tangential forces are multiplied too.
  template <class S>
  [[gnu::always_inline]] S prefactor(const ContactOf<S>&) const {
    return S(1.0);
  }
  double elastic_energy(const Contact& c) const { return 0.5 * stiffness * c.overlap * c.overlap; }

  /// Duration of a collision without damping, pi sqrt(m_ij / k) [time].
  double contact_time(double reduced_mass) const {
    return std::numbers::pi * std::sqrt(reduced_mass / stiffness);
  }
  /// Duration of a collision with damping (Brewster eq. 8) [time].
  double collision_time(double reduced_mass) const {
    const double rate = viscosity(*this, reduced_mass) / reduced_mass;
    return std::numbers::pi / std::sqrt(stiffness / reduced_mass - 0.25 * rate * rate);
  }
  /// Normal restitution (Brewster eq. 7).
  double restitution(double reduced_mass) const {
    const double rate = viscosity(*this, reduced_mass) / reduced_mass;
    return std::exp(-0.5 * rate * collision_time(reduced_mass));
  }
};

/// gamma_n [1/time] that gives a pair the wanted restitution (Brewster eqs. 7 and 8 inverted).
inline double damping_for(double restitution, double stiffness, double reduced_mass) {
  const double loss = -std::log(restitution);
  const double ratio = loss / std::hypot(std::numbers::pi, loss);
  return 2.0 * ratio * std::sqrt(stiffness / reduced_mass);
}

/// The root_damping that gives all pairs the wanted restitution [sqrt(mass)/time].
inline double root_damping_for(double restitution, double stiffness) {
  return damping_for(restitution, stiffness, 1.0);
}

/// Hertz: f = sqrt(overlap / (R_i + R_j)) (k overlap - gamma m_ij v_n): the prefactor stands before
/// spring and dashpot alike (Brewster et al. 2008, eq. 2 with f(x) = sqrt(x)). At a wall R_j = 0
/// makes the contact sqrt(2) times stiffer, as for a sphere on a plane.
struct Hertz {
  static constexpr std::string_view name = "hertz";
  static constexpr bool constant_prefactor = false;
  double stiffness = 0.0;                      ///< k_n [mass/time^2]
  double damping = 0.0;                        ///< gamma_n [1/time], times the reduced mass
  bool clip_attraction = false;                ///< no negative force between touching grains
  double dashpot = 0.0;                        ///< gamma_n [mass/time], the same for all pairs
  static constexpr double root_damping = 0.0;  ///< no single restitution

  template <class S>
  [[gnu::always_inline]] S prefactor(const ContactOf<S>& c) const {
    return sqrt(max(c.overlap, S(0.0)) / c.radius_sum);
  }
  template <class S>
  [[gnu::always_inline]] S elastic_force(const ContactOf<S>& c) const {
    return prefactor(c) * stiffness * c.overlap;
  }
  template <class S>
  [[gnu::always_inline]] S force(const ContactOf<S>& c) const {
    const S total = prefactor(c) *
                    (stiffness * c.overlap - viscosity(*this, c.reduced_mass) * c.normal_velocity);
    return clip_attraction ? max(total, S(0.0)) : total;
  }
  double elastic_energy(const Contact& c) const {
    return 0.4 * prefactor(c) * stiffness * c.overlap * c.overlap;
  }

  /// Half period of a pair at the tangent stiffness 3/2 k sqrt(x) of the relative overlap x [time].
  double contact_time(double reduced_mass, double relative_overlap) const {
    const double tangent = 1.5 * stiffness * std::sqrt(relative_overlap);
    return std::numbers::pi * std::sqrt(reduced_mass / tangent);
  }
  /// Duration of a collision without damping at a closing speed v, for grains of diameter d:
  /// 3.218 (m_ij sqrt(d) / k)^0.4 v^-0.2 [time].
  double collision_time(double reduced_mass, double diameter, double speed) const {
    return 3.2181 * std::pow(reduced_mass * std::sqrt(diameter) / stiffness, 0.4) *
           std::pow(speed, -0.2);
  }
};

}  // namespace grainlaw::dem
