#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/contact.h"

namespace grainlaw::dem {

/// Where the energy of a tangential contact goes during one step.
struct TangentialWork {
  double elastic_energy = 0.0;  ///< stored in the spring now [energy]
  double dashpot = 0.0;         ///< dissipated in this step [energy]
  double slip = 0.0;            ///< dissipated in this step [energy]
};

/// No tangential force: grains do not rotate and contacts remember nothing.
struct Frictionless {
  static constexpr std::string_view name = "none";
  static constexpr bool rotates = false;
  struct History {};
};

/// Tangential spring and dashpot cut at the Coulomb limit, F_t = -k_t u - gamma_t m_ij v_t with
/// |F_t| <= mu |F_n| by shortening u  (Brewster et al. 2008, eq. 3 and text below).
struct Sliding {
  static constexpr std::string_view name = "sliding";
  static constexpr bool rotates = true;
  double coefficient = 0.0;  ///< mu_p
  double stiffness = 0.0;    ///< k_t [mass/time^2]
  double damping = 0.0;      ///< gamma_t [1/time], times the reduced mass

  /// The spring half a step after the last force, as leapfrog keeps velocities: the force takes
  /// it half a step on, so that spring and velocity are centred and the law is of second order.
  struct History {
    Vec3 spring;  ///< u at n + 1/2, along the surface velocity of i past j [length]
  };

  /// Tangential force on i [force]; moves the history on to the next half step.
  Vec3 force(const Contact& contact,
             const TangentialMotion& motion,
             double normal_force,
             double time_step,
             History& history,
             TangentialWork& work) const {
    const Vec3 half_advance = 0.5 * time_step * motion.surface_velocity;
    const Vec3 carried = turned(history.spring, contact.normal, motion.normal_rate, time_step);
    const Vec3 stretched = carried + half_advance;
    const Vec3 dashpot = -damping * contact.reduced_mass * motion.surface_velocity;
    Vec3 force = dashpot - stiffness * stretched;
    Vec3 spring = stretched;
    const double limit = coefficient * std::abs(normal_force);
    const double magnitude2 = square(force);
    if (magnitude2 > limit * limit) {
      force = (limit / std::sqrt(magnitude2)) * force;
      spring = (1.0 / stiffness) * (dashpot - force);
      // Mean spring force over the step times what slipped: with the change of the stored energy
      // this is exactly the work of the mean spring force over the advance.
      const Vec3 mean_spring = 0.5 * (spring + carried - half_advance);
      work.slip += stiffness * dot(mean_spring, stretched - spring);
    }
    history.spring = spring + half_advance;
    work.elastic_energy += 0.5 * stiffness * square(spring);
    work.dashpot += damping * contact.reduced_mass * square(motion.surface_velocity) * time_step;
    return force;
  }

  /// Elastic energy left in a contact that opens; it is lost [energy].
  double energy_lost(const History& history) const {
    return 0.5 * stiffness * square(history.spring);
  }

  /// Half period of the tangential spring of two free solid spheres of mass m, whose mass at the
  /// contact point is m / 7 [time].
  double contact_time(double grain_mass) const {
    return std::numbers::pi * std::sqrt(grain_mass / 7.0 / stiffness);
  }

 private:
  /// Turns the spring with the contact plane, keeping its length to third order in the step:
  /// rotation from the old normal n - dt n' to n.
  static Vec3 turned(const Vec3& spring, const Vec3& normal, const Vec3& rate, double time_step) {
    return spring - dot(normal, spring) * (normal - 0.5 * time_step * rate);
  }
};

}  // namespace grainlaw::dem
