#pragma once

#include "dem/particles.h"

namespace grainlaw::dem {

/// What moves equal solid spheres besides their contacts.
struct Dynamics {
  double mass = 1.0;       ///< of a grain [mass]
  Vec3 gravity;            ///< [length/time^2]
  double time_step = 0.0;  ///< [time]
};

/// Extremes of one step.
struct Motion {
  double fastest = 0.0;  ///< largest speed relative to the given frame [length/time]; NaN if any is
  double lowest = 0.0;   ///< smallest z of a mobile grain [length]; NaN if any is
};

/// One step of the leapfrog form of velocity Verlet from n to n + 1; clears the loads.
/// Dashpots and friction need the velocity at n + 1 before the force there is known: it is
/// predicted with the acceleration extrapolated over the last two steps,
/// v(n + 1/2) + dt/2 (2 a(n) - a(n - 1)). The lagged velocity v(n + 1/2) would cost one order in
/// the damping; v(n + 1/2) + dt/2 a(n) is of second order but books its dissipation too high by
/// (omega dt)^2 / 2, 2e-3 at the default step.
Motion advance(Particles& particles, const Dynamics& dynamics, const Vec3& frame_velocity);

/// Velocities at the time of the present loads, v(n - 1/2) + dt/2 a(n) [length/time].
Vec3 velocity(const Particles& particles, std::size_t i, const Dynamics& dynamics);
Vec3 spin(const Particles& particles, std::size_t i, const Dynamics& dynamics);  ///< R omega

/// Sets the half-step velocities so that velocity() and spin() give the predicted ones, which
/// become exact: for a start, or when gravity has been changed.
void restart_half_step(Particles& particles, const Dynamics& dynamics);

/// Of the mobile grains at the time of the present loads, translation and rotation [energy].
double kinetic_energy(const Particles& particles, const Dynamics& dynamics);

}  // namespace grainlaw::dem
