#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "dem/vec3.h"

namespace grainlaw::dem {

/// What a contact reads of a grain: one cache line.
struct alignas(64) GrainState {
  Vec3 position;  ///< [length]
  double unused_after_position = 0.0;
  Vec3 velocity;  ///< predicted for the time of the position, second order in the step
  double unused_after_velocity = 0.0;
};

/// A vector that fills half a cache line.
struct alignas(32) PaddedVec3 : Vec3 {};

/// What contacts add up on a grain.
struct alignas(64) GrainLoad {
  Vec3 force;
  double unused_after_force = 0.0;
  Vec3 torque;  ///< divided by the radius [force]
  double unused_after_torque = 0.0;
};

/// Equal spheres, the mobile ones first, the frozen ones after them. Rotation is kept as R omega,
/// the speed of the equator; its arrays stay empty where the law has no friction.
struct Particles {
  std::size_t mobile = 0;
  std::vector<GrainState> state;
  std::vector<PaddedVec3> spin;  ///< R omega, predicted like the velocity [length/time]
  std::vector<GrainLoad> load;
  std::vector<Vec3> half_velocity;   ///< at n - 1/2, mobile grains
  std::vector<Vec3> half_spin;       ///< at n - 1/2, mobile grains
  std::vector<Vec3> last_rate;       ///< d(velocity)/dt at the last step, mobile grains
  std::vector<Vec3> last_spin_rate;  ///< d(R omega)/dt at the last step, mobile grains
  std::vector<std::uint32_t> id;     ///< of the grain when the simulation was made

  std::size_t size() const { return state.size(); }
};

}  // namespace grainlaw::dem
