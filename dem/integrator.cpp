#include "dem/integrator.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

// m R^2 / I of a solid sphere: d(R omega)/dt = 5/2 (torque / R) / m.
constexpr double inertia_ratio = 2.5;

Vec3 acceleration(const GrainLoad& load, const Dynamics& dynamics) {
  return (1.0 / dynamics.mass) * load.force + dynamics.gravity;
}

Vec3 spin_acceleration(const GrainLoad& load, const Dynamics& dynamics) {
  return (inertia_ratio / dynamics.mass) * load.torque;
}

void advance_spins(Particles& particles, const Dynamics& dynamics) {
  const double dt = dynamics.time_step;
  for (std::size_t i = 0; i < particles.half_spin.size(); ++i) {
    const Vec3 rate = spin_acceleration(particles.load[i], dynamics);
    particles.half_spin[i] += dt * rate;
    static_cast<Vec3&>(particles.spin[i]) =
        particles.half_spin[i] + dt * (rate - 0.5 * particles.last_spin_rate[i]);
    particles.last_spin_rate[i] = rate;
  }
}

}  // namespace

Motion advance(Particles& particles, const Dynamics& dynamics, const Vec3& frame_velocity) {
  const double dt = dynamics.time_step;
  advance_spins(particles, dynamics);
  double fastest2 = 0.0;
  double lowest = INFINITY;
  double sum = 0.0;  // carries any NaN, which comparisons would drop
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    GrainState& grain = particles.state[i];
    const Vec3 rate = acceleration(particles.load[i], dynamics);
    const Vec3 half = particles.half_velocity[i] + dt * rate;
    particles.half_velocity[i] = half;
    grain.position += dt * half;
    grain.velocity = half + dt * (rate - 0.5 * particles.last_rate[i]);
    particles.last_rate[i] = rate;
    particles.load[i] = {};
    const double speed2 = square(half - frame_velocity);
    fastest2 = std::max(fastest2, speed2);
    lowest = std::min(lowest, grain.position.z);
    sum += speed2;
  }
  for (std::size_t i = particles.mobile; i < particles.size(); ++i) particles.load[i] = {};
  return {std::isfinite(sum) ? std::sqrt(fastest2) : NAN, lowest};
}

Vec3 velocity(const Particles& particles, std::size_t i, const Dynamics& dynamics) {
  return particles.half_velocity[i] +
         0.5 * dynamics.time_step * acceleration(particles.load[i], dynamics);
}

Vec3 spin(const Particles& particles, std::size_t i, const Dynamics& dynamics) {
  return particles.half_spin[i] +
         0.5 * dynamics.time_step * spin_acceleration(particles.load[i], dynamics);
}

void restart_half_step(Particles& particles, const Dynamics& dynamics) {
  const double half = 0.5 * dynamics.time_step;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const Vec3 rate = acceleration(particles.load[i], dynamics);
    particles.half_velocity[i] = particles.state[i].velocity - half * rate;
    particles.last_rate[i] = rate;
  }
  for (std::size_t i = 0; i < particles.half_spin.size(); ++i) {
    const Vec3 rate = spin_acceleration(particles.load[i], dynamics);
    particles.half_spin[i] = particles.spin[i] - half * rate;
    particles.last_spin_rate[i] = rate;
  }
}

double kinetic_energy(const Particles& particles, const Dynamics& dynamics) {
  double sum = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i)
    sum += square(velocity(particles, i, dynamics));
  for (std::size_t i = 0; i < particles.half_spin.size(); ++i) {
    sum += square(spin(particles, i, dynamics)) / inertia_ratio;
  }
  return 0.5 * dynamics.mass * sum;
}

}  // namespace grainlaw::dem
