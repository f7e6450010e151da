#include "dem/drive.h"

#include <cmath>

namespace grainlaw::dem {
namespace {

template <class Change>
void for_movers(Particles& particles, Change&& change) {
  for (std::size_t i = particles.mobile; i < particles.real; ++i) {
    if (particles.body[i] == Body::mover) change(i);
  }
}

void move(const Still&, double, Box&, Particles&) {}

void move(const BoxDrive& drive, double dt, Box& box, Particles&) {
  const double old_height = box.period.y;
  box.period.y += dt * drive.height_rate;
  const double half_height = 0.5 * (old_height + box.period.y);
  box.offset += dt * drive.shear_rate * half_height;
  box.half_top_velocity = {drive.shear_rate * half_height, drive.height_rate, 0.0};
  box.top_velocity = {drive.shear_rate * box.period.y,
                      drive.height_rate + 0.5 * dt * drive.height_acceleration,
                      0.0};
}

void move(const WallDrive& drive, double dt, Box&, Particles& particles) {
  const Vec3 way{dt * drive.velocity, 0.0, dt * drive.rise};
  const Vec3 velocity{drive.velocity, 0.0, drive.rise + 0.5 * dt * drive.acceleration};
  for_movers(particles, [&](std::size_t i) {
    particles.state[i].position += way;
    particles.state[i].velocity = velocity;
  });
}

void move(const RotationDrive& drive, double dt, Box&, Particles& particles) {
  const double cosine = std::cos(drive.rate * dt);
  const double sine = std::sin(drive.rate * dt);
  for_movers(particles, [&](std::size_t i) {
    GrainState& grain = particles.state[i];
    grain.position = turned(grain.position, cosine, sine);
    grain.velocity = {-drive.rate * grain.position.y, drive.rate * grain.position.x, 0.0};
    if (particles.rotates()) particles.spin[i].velocity = {0.0, 0.0, drive.rate * grain.radius};
  });
}

void react(Still&, double, double, const Box&, const Particles&, Dynamics&) {}
void react(RotationDrive&, double, double, const Box&, const Particles&, Dynamics&) {}

void react(BoxDrive& drive,
           double dt,
           double stress_yy,
           const Box& box,
           const Particles&,
           Dynamics& dynamics) {
  if (!drive.pressure) return;
  const double height = box.period.y;
  drive.height_acceleration =
      height * drive.gain * (stress_yy - *drive.pressure) - drive.damping * drive.height_rate;
  const double rate_now = drive.height_rate + 0.5 * dt * drive.height_acceleration;
  drive.height_rate += dt * drive.height_acceleration;
  const double strain_rate = rate_now / height;
  const double strain_rate_rate = drive.height_acceleration / height - strain_rate * strain_rate;
  if (auto* sine = std::get_if<Sine>(&dynamics.field)) {
    sine->wave_number = 2.0 * std::numbers::pi / height;
    sine->strain_rate = strain_rate;
    sine->strain_rate_rate = strain_rate_rate;
  } else if (auto* affine = std::get_if<Affine>(&dynamics.field)) {
    affine->shear_rate = drive.shear_rate;
    affine->strain_rate = strain_rate;
    affine->strain_rate_rate = strain_rate_rate;
  } else {
    dynamics.field = Affine{drive.shear_rate, strain_rate, strain_rate_rate, 0.5 * height};
  }
}

void react(WallDrive& drive, double dt, double, const Box&, const Particles& particles, Dynamics&) {
  if (!drive.load) return;
  const double force = force_on(particles, Body::mover).z - *drive.load;
  drive.acceleration = (force - drive.damping * drive.rise) / drive.mass;
  drive.rise += dt * drive.acceleration;
}

}  // namespace

void move_boundaries(const Drive& drive, double time_step, Box& box, Particles& particles) {
  std::visit([&](const auto& d) { move(d, time_step, box, particles); }, drive);
}

void start_boundaries(const Drive& drive, Box& box, Particles& particles) {
  move_boundaries(drive, 0.0, box, particles);
}

void control(Drive& drive,
             double time_step,
             double stress_yy,
             const Box& box,
             const Particles& particles,
             Dynamics& dynamics) {
  std::visit([&](auto& d) { react(d, time_step, stress_yy, box, particles, dynamics); }, drive);
}

double boundary_power(const Particles& particles) {
  double power = 0.0;
  for (std::size_t i = particles.mobile; i < particles.size(); ++i) {
    if (particles.state[i].inverse_mass > 0.0) continue;  // the image of a mobile grain
    power -= dot(particles.load[i].force, particles.state[i].velocity);
    if (particles.rotates()) power -= dot(particles.load[i].torque, particles.spin[i].velocity);
  }
  return power;
}

Vec3 force_on(const Particles& particles, Body body) {
  Vec3 force;
  for (std::size_t i = particles.mobile; i < particles.real; ++i) {
    if (particles.body[i] == body) force += particles.load[i].force;
  }
  return force;
}

}  // namespace grainlaw::dem
