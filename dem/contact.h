#pragma once

#include "dem/vec3.h"

namespace grainlaw::dem {

/// Kinematics of one contact as a law sees it. All sign conventions of the engine are here:
/// i is the first grain, j the second, the normal points from j to i, the relative velocity is
/// v_i - v_j, forces are those on i. Positive normal velocity separates, positive normal force
/// pushes apart.
struct Contact {
  Vec3 normal;
  double distance = 0.0;         ///< of the centres [length]
  double overlap = 0.0;          ///< > 0 where the grains touch [length]
  double normal_velocity = 0.0;  ///< [length/time]
  double reduced_mass = 0.0;     ///< m_i m_j / (m_i + m_j); m_i where j is frozen [mass]
};

/// Motion in the contact plane.
struct TangentialMotion {
  Vec3 surface_velocity;  ///< of i past j at the contact point, rotation included [length/time]
  Vec3 normal_rate;       ///< d(normal)/dt, by which the contact plane turns [1/time]
};

}  // namespace grainlaw::dem
