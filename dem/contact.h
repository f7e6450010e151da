#pragma once

#include "dem/simd.h"
#include "dem/vec3.h"

namespace grainlaw::dem {

/// Kinematics of one contact as a law sees it. All sign conventions of the engine are here:
/// i is the first grain, j the second, the normal points from j to i, the relative velocity is
/// v_i - v_j, forces are those on i. Positive normal velocity separates, positive normal force
/// pushes apart. S is double for one contact, Pack for several at once. A flat wall is a partner of
/// radius 0 and infinite mass at the nearest point of the wall.
template <class S>
struct ContactOf {
  Vector3<S> normal;
  S distance = S(0.0);          ///< of the centres [length]
  S inverse_distance = S(0.0);  ///< [1/length]
  S overlap = S(0.0);           ///< > 0 where the grains touch, < 0: a gap [length]
  S normal_velocity = S(0.0);   ///< [length/time]
  S reduced_mass = S(0.0);      ///< m_i m_j / (m_i + m_j); m_i where j is frozen [mass]
  S radius_sum = S(0.0);        ///< R_i + R_j [length]
  S harmonic_radius = S(0.0);   ///< 2 R_i R_j / (R_i + R_j), 2 R_i at a wall; only for laws that
                                ///< need it [length]
};
using Contact = ContactOf<double>;

/// Motion in the contact plane.
template <class S>
struct TangentialMotion {
  Vector3<S> surface_velocity;  ///< of i past j at the contact point, rotation included
                                ///< [length/time]
  Vector3<S> normal_rate;       ///< d(normal)/dt, by which the contact plane turns [1/time]
};

}  // namespace grainlaw::dem
