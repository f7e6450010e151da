#pragma once

#include <optional>
#include <variant>

#include "dem/box.h"
#include "dem/integrator.h"
#include "dem/particles.h"
#include "dem/walls.h"

namespace grainlaw::dem {

/// Boundaries that stand still.
struct Still {};

/// The height of a periodic box, moved like a piston so that sigma_yy keeps its value in the mean:
/// d2L/dt2 = L gain (sigma_yy - pressure) - damping dL/dt. With a shear rate the images above and
/// below move along x with it.
struct BoxDrive {
  double shear_rate = 0.0;           ///< [1/time]
  std::optional<double> pressure{};  ///< [stress]; absent: fixed height
  double gain = 0.0;                 ///< [1/(stress time^2)]
  double damping = 0.0;              ///< [1/time]
  double height_rate = 0.0;          ///< dL/dt at the last half step [length/time]
  double height_acceleration = 0.0;  ///< at the last step
};

/// Glued grains of Body::mover that move together: along x at a given velocity, and along z, where
/// a load is given, like a plate of that mass under load, contact forces and damping.
struct WallDrive {
  double velocity = 0.0;         ///< along x [length/time]
  std::optional<double> load{};  ///< downwards, on the whole wall [force]; absent: fixed gap
  double mass = 1.0;             ///< [mass]
  double damping = 0.0;          ///< of the vertical motion [mass/time]
  double rise = 0.0;             ///< dz/dt at the last half step [length/time]
  double acceleration = 0.0;     ///< d2z/dt2 at the last step
};

/// Glued grains of Body::mover that turn about z.
struct RotationDrive {
  double rate = 0.0;  ///< [1/time]
};

using Drive = std::variant<Still, BoxDrive, WallDrive, RotationDrive>;

/// Moves box and frozen grains from n to n + 1, with their velocities at n + 1.
void move_boundaries(const Drive& drive, double time_step, Box& box, Particles& particles);

/// Sets velocities of box and frozen grains for a start.
void start_boundaries(const Drive& drive, Box& box, Particles& particles);

/// Reacts to the loads of step n; `stress_yy` is that of the box. Changes the field with the
/// height.
void control(Drive& drive,
             double time_step,
             double stress_yy,
             const Box& box,
             const Particles& particles,
             Dynamics& dynamics);

/// Power that frozen grains and feet hand to the others by their motion [energy/time].
double boundary_power(const Particles& particles);

/// Sum of the loads on the grains of a body [force].
Vec3 force_on(const Particles& particles, Body body);

}  // namespace grainlaw::dem
