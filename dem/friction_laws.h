#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/contact.h"

namespace grainlaw::dem {

/// Where the energy of tangential contacts goes during one step.
template <class S>
struct TangentialWork {
  S dashpot = S(0.0);         ///< dissipated in this step [energy]
  S slip = S(0.0);            ///< dissipated in this step [energy]
  S elastic_energy = S(0.0);  ///< in the spring now [energy]
};

/// What a tangential contact remembers.
template <class S>
struct TangentialSpring {
  Vector3<S> stretch;   ///< u at n + 1/2, along the surface velocity of i past j [length]
  S slipping = S(0.0);  ///< 1: slips, held by dynamic friction (StickSlip only)
};

/// How the normal contact bounds and scales the tangential one.
template <class S>
struct NormalLoad {
  S coulomb_reference = S(0.0);  ///< friction is at most mu times this [force]
  S prefactor = S(1.0);          ///< f(x) of the normal law, before spring and dashpot
  S inverse_prefactor = S(1.0);
};

/// No tangential force: grains do not rotate and contacts remember nothing.
struct Frictionless {
  static constexpr std::string_view name = "none";
  static constexpr bool rotates = false;
};

/// Tangential spring and dashpot cut at the Coulomb limit, F_t = -f(x) (k_t u + gamma_t m_ij v_t)
/// with |F_t| <= mu F_ref by shortening u  (Brewster et al. 2008, eq. 3 and text below;
/// Shi et al. 2020, section 2.1). The spring is kept half a step after the last force, as leapfrog
/// keeps velocities: the force takes it half a step on, so that spring and velocity are centred and
/// the law is of second order.
struct Sliding {
  static constexpr std::string_view name = "sliding";
  static constexpr bool rotates = true;
  static constexpr bool remembers_slip = false;
  double coefficient = 0.0;  ///< mu_p, static and dynamic
  double stiffness = 0.0;    ///< k_t [mass/time^2]
  double damping = 0.0;      ///< gamma_t [1/time], times the reduced mass
  double dashpot = 0.0;      ///< gamma_t [mass/time], the same for all pairs

  template <class S>
  [[gnu::always_inline]] S limit(const NormalLoad<S>& load,
                                 const TangentialSpring<S>&,
                                 const S&) const {
    return coefficient * load.coulomb_reference;
  }
};

/// Sliding with a static coefficient above the dynamic one: a contact sticks up to the static
/// limit, then slips at the dynamic one until its trial force falls below that
/// (Luding, Granular Matter 10 (2008) 235, section 2.4).
struct StickSlip {
  static constexpr std::string_view name = "stick_slip";
  static constexpr bool rotates = true;
  static constexpr bool remembers_slip = true;
  double static_coefficient = 0.0;  ///< mu_s
  double coefficient = 0.0;         ///< mu_d, dynamic, below mu_s
  double stiffness = 0.0;           ///< k_t [mass/time^2]
  double damping = 0.0;             ///< gamma_t [1/time], times the reduced mass
  double dashpot = 0.0;             ///< gamma_t [mass/time], the same for all pairs

  template <class S>
  [[gnu::always_inline]] S limit(const NormalLoad<S>& load,
                                 const TangentialSpring<S>& spring,
                                 const S& trial2) const {
    const S low = coefficient * load.coulomb_reference;
    const S high = static_coefficient * load.coulomb_reference;
    return select(spring.slipping > 0.5 || trial2 > high * high, low, high);
  }
};

/// Tangential force on i [force]; moves the spring on to the next half step.
template <class Law, class S>
[[gnu::always_inline]] inline Vector3<S> friction_force(const Law& law,
                                                        const ContactOf<S>& contact,
                                                        const TangentialMotion<S>& motion,
                                                        const NormalLoad<S>& load,
                                                        double time_step,
                                                        TangentialSpring<S>& spring,
                                                        TangentialWork<S>& work) {
  const Vector3<S>& velocity = motion.surface_velocity;
  const Vector3<S> half_advance = S(0.5 * time_step) * velocity;
  // Turns the spring with the contact plane, keeping its length to third order in the step:
  // rotation from the old normal n - dt n' to n.
  const Vector3<S> old_middle = contact.normal - S(0.5 * time_step) * motion.normal_rate;
  const Vector3<S> carried = spring.stretch - dot(contact.normal, spring.stretch) * old_middle;
  const Vector3<S> stretched = carried + half_advance;
  const S viscosity = load.prefactor * (law.damping * contact.reduced_mass + law.dashpot);
  const S stiffness = law.stiffness * load.prefactor;
  const S inverse_stiffness = load.inverse_prefactor * (1.0 / law.stiffness);
  const Vector3<S> dashpot = -viscosity * velocity;
  const Vector3<S> trial = dashpot - stiffness * stretched;
  const S trial2 = square(trial);
  const S limit = law.limit(load, spring, trial2);
  const Mask<S> slips = trial2 > limit * limit;
  const Vector3<S> force = select(slips, limit * inverse_sqrt(trial2), S(1.0)) * trial;
  const Vector3<S> cut = inverse_stiffness * (dashpot - force);
  const Vector3<S> held{select(slips, cut.x, stretched.x),
                        select(slips, cut.y, stretched.y),
                        select(slips, cut.z, stretched.z)};
  // Mean spring force over the step times what slipped: with the change of the stored energy this
  // is exactly the work of the mean spring force over the advance.
  const Vector3<S> twice_mean = held + carried - half_advance;
  work.slip = stiffness * 0.5 * dot(twice_mean, stretched - held);
  work.dashpot = viscosity * time_step * square(velocity);
  work.elastic_energy = 0.5 * stiffness * square(held);
  spring.stretch = held + half_advance;
  if constexpr (Law::remembers_slip) spring.slipping = select(slips, S(1.0), S(0.0));
  return force;
}

/// Elastic energy in a spring [energy]; lost when the contact opens.
template <class Law>
double spring_energy(const Law& law, const Vec3& stretch, double prefactor) {
  return 0.5 * law.stiffness * prefactor * square(stretch);
}

/// Half period of the tangential spring of two free solid spheres of mass m, whose mass at the
/// contact point is m / 7 [time].
template <class Law>
double tangential_contact_time(const Law& law, double grain_mass) {
  return std::numbers::pi * std::sqrt(grain_mass / 7.0 / law.stiffness);
}

}  // namespace grainlaw::dem
