#pragma once

#include <variant>

#include "dem/particles.h"
#include "dem/simd.h"

namespace grainlaw::dem {

/// The same acceleration everywhere.
struct Uniform {
  Vec3 acceleration;  ///< [length/time^2]
};

/// A force per mass along x that varies along y, F (sin(k y) - mean), the mean over the mass of the
/// grains: grains are never spread so evenly that the sine alone would not push the whole box.
struct Sine {
  double amplitude = 0.0;    ///< F [length/time^2]
  double wave_number = 0.0;  ///< k [1/length]
  double mean = 0.0;         ///< of sin(k y) over the mass; see balance()
  double strain_rate = 0.0;  ///< of the height of the box [1/time]; see Affine
  double strain_rate_rate = 0.0;
  double middle = 0.0;
};

/// What keeps a periodic box homogeneous while its height changes: for velocities that follow
/// v = G x + peculiar, G = (shear_rate, strain_rate) d/dy, the images ask of every grain the
/// acceleration (dG/dt + G G) x. It vanishes while the height stands still. x counts from a place
/// that stays where it is: about the middle of the moving box the mean acceleration would be
/// e^2 L_y / 2, and the packing would drift along y ever faster.
struct Affine {
  double shear_rate = 0.0;        ///< [1/time]
  double strain_rate = 0.0;       ///< e = dL_y/dt / L_y [1/time]
  double strain_rate_rate = 0.0;  ///< de/dt [1/time^2]
  double middle = 0.0;  ///< y where it vanishes: the middle of the box at the start [length]
};

/// What moves solid spheres besides their contacts.
struct Dynamics {
  double time_step = 0.0;  ///< [time]
  std::variant<Uniform, Sine, Affine> field = Uniform{};
};

/// A flow against which grains are watched: v_x = velocity + gradient (x_axis), the rest at rest.
struct Frame {
  double velocity = 0.0;  ///< where the coordinate is 0 [length/time]
  double gradient = 0.0;  ///< [1/time]
  bool along_y = false;   ///< the coordinate: y, else z
};

/// Extremes and sums of one step over a stretch of grains.
struct Motion {
  Vec3 fastest;             ///< largest speed relative to the frame, by component [length/time]
  Vec3 lowest;              ///< smallest coordinates [length]
  Vec3 highest;             ///< largest coordinates [length]
  double field_work = 0.0;  ///< done by a field that is not uniform [energy]
  double kinetic_yy = 0.0;  ///< sum of m c_y^2, c_y = v_y less the strain of the box, at the half
                            ///< step; where the field is not uniform [energy]
  bool finite = true;

  Motion& operator+=(const Motion& b);
};

/// One step of the leapfrog form of velocity Verlet from n to n + 1 for mobile grains [begin, end);
/// clears their loads. Dashpots and friction need the velocity at n + 1 before the force there is
/// known: it is predicted with the acceleration extrapolated over the last two steps,
/// v(n + 1/2) + dt/2 (2 a(n) - a(n - 1)). The lagged velocity v(n + 1/2) would cost one order in
/// the damping; v(n + 1/2) + dt/2 a(n) is of second order but books its dissipation too high by
/// (omega dt)^2 / 2, 2e-3 at the default step.
Motion advance(Particles& particles,
               const Dynamics& dynamics,
               const Frame& frame,
               std::size_t begin,
               std::size_t end);

/// Takes the mean of a sine anew for grains that have moved: it gives them no momentum together.
void balance(Dynamics& dynamics, const Particles& particles);

/// Acceleration of the field at a point [length/time^2].
Vec3 field_acceleration(const Dynamics& dynamics, const Vec3& position);

/// Velocities at the time of the present loads, v(n - 1/2) + dt/2 a(n) [length/time].
Vec3 velocity(const Particles& particles, std::size_t i, const Dynamics& dynamics);
Vec3 spin(const Particles& particles, std::size_t i, const Dynamics& dynamics);  ///< R omega

/// Sets the half-step velocities so that velocity() and spin() give the predicted ones, which
/// become exact: for a start, or when the field has been changed.
void restart_half_step(Particles& particles, const Dynamics& dynamics);

/// Of the mobile grains at the time of the present loads, translation and rotation [energy].
double kinetic_energy(const Particles& particles, const Dynamics& dynamics);

}  // namespace grainlaw::dem
