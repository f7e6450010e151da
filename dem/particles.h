#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem/initial_state.h"
#include "dem/vec3.h"

namespace grainlaw::dem {

/// What a contact reads of a grain: one cache line. Radius and mass sit where vectors of three
/// leave room, so that equal and unequal grains are the same code.
struct alignas(64) GrainState {
  Vec3 position;              ///< [length]
  double radius = 0.0;        ///< 0: a point of a wall [length]
  Vec3 velocity;              ///< predicted for the time of the position, second order in the step
  double inverse_mass = 0.0;  ///< 0: frozen, a wall [1/mass]
};

/// Rotation of a grain, as the speed of its equator.
struct alignas(32) GrainSpin {
  Vec3 velocity;      ///< R omega, predicted like the velocity [length/time]
  double grip = 0.5;  ///< the sum over a pair multiplies friction: -0.5 on a smooth wall
};

/// What contacts add up on a grain.
struct alignas(64) GrainLoad {
  Vec3 force;
  double unused_after_force = 0.0;
  Vec3 torque;  ///< divided by the radius [force]
  double unused_after_torque = 0.0;
};

/// What leapfrog carries from step to step, for velocities and for spins.
struct alignas(64) HalfStep {
  Vec3 velocity;        ///< at n - 1/2 [length/time]
  double beside = 0.0;  ///< what stands beside the predicted velocity: inverse mass, or grip
  Vec3 last_rate;       ///< d(velocity)/dt at the last step [length/time^2]
  double unused = 0.0;
};

/// Spheres: the mobile ones first, the frozen ones after them, then points that stand for others:
/// feet of mobile grains on flat or round walls, and images of grains by rotation. The arrays of
/// rotation stay empty where the law has no friction.
struct Particles {
  std::size_t mobile = 0;
  std::size_t real = 0;  ///< mobile and frozen
  std::vector<GrainState> state;
  std::vector<GrainSpin> spin;
  std::vector<GrainLoad> load;
  std::vector<HalfStep> half;       ///< mobile grains
  std::vector<HalfStep> half_spin;  ///< mobile grains, rotation
  std::vector<std::uint32_t> id;    ///< of the grain when the simulation was made
  std::vector<Body> body;           ///< of the real grains

  std::size_t size() const { return state.size(); }
  bool rotates() const { return !spin.empty(); }
};

/// Numbers of walls begin here in Particles::id.
inline constexpr std::uint32_t first_wall_id = 0x80000000u;

/// The grains of an initial state, numbered mobile first, in the order given, at rest in their half
/// steps. Masses follow from the density.
Particles make_particles(const InitialState& initial, double density, bool rotates);

/// Moves the real grains to the order given (new place -> old place).
void reorder(Particles& particles, const std::vector<std::uint32_t>& order);

/// What wrap() did: sums over the mobile grains.
struct Wrapping {
  Vec3 displacement;            ///< sum of m times the way [mass length]
  double kinetic_energy = 0.0;  ///< gained by those that passed a moving image [energy]
};

/// Brings all real grains into the box, with the velocity of the image they become. Grains that
/// pass a face of a wedge turn with it; `turns` gets the angle of every real grain, if asked for.
Wrapping wrap(Particles& particles, const Box& box, std::vector<double>* turns = nullptr);

}  // namespace grainlaw::dem
