#include "dem/particles.h"

#include <cmath>
#include <numbers>

#include "dem/box.h"

namespace grainlaw::dem {
namespace {

template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& order, std::size_t count) {
  std::vector<T> sorted(count);
  for (std::size_t i = 0; i < count; ++i) sorted[i] = values[order[i]];
  values.swap(sorted);
}

void place(Particles& particles, std::size_t i, const InitialGrain& grain, double density) {
  const double radius = 0.5 * grain.diameter;
  const double volume = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  const bool mobile = grain.body == Body::none;
  const double inverse_mass = mobile ? 1.0 / (density * volume) : 0.0;
  particles.state[i] = {grain.position, radius, grain.velocity, inverse_mass};
  particles.body[i] = grain.body;
  if (mobile) particles.half[i].beside = inverse_mass;
  if (!particles.rotates()) return;
  particles.spin[i].velocity = radius * grain.rotation;
  if (mobile) particles.half_spin[i].beside = particles.spin[i].grip;
}

/// Number of whole periods by which x lies outside [0, period).
double periods_off(double x, double period) {
  return period == 0.0 ? 0.0 : std::floor(x / period);
}

/// Turns the grain back into the wedge; returns the angle.
double turn_back(Particles& particles, std::size_t i, double wedge) {
  const Vec3& p = particles.state[i].position;
  const double angle = -wedge * std::floor(std::atan2(p.y, p.x) / wedge);
  if (angle == 0.0) return 0.0;
  const auto turn = [&](Vec3& v) { v = turned(v, angle); };
  turn(particles.state[i].position);
  turn(particles.state[i].velocity);
  if (particles.rotates()) turn(particles.spin[i].velocity);
  if (i >= particles.mobile) return angle;
  turn(particles.half[i].velocity);
  turn(particles.half[i].last_rate);
  if (particles.rotates()) {
    turn(particles.half_spin[i].velocity);
    turn(particles.half_spin[i].last_rate);
  }
  return angle;
}

/// Moves the grain into a box of periods; returns the periods it was above in y.
double shift_back(GrainState& grain, const Box& box) {
  Vec3& p = grain.position;
  const double above = periods_off(p.y, box.period.y);
  p.y -= above * box.period.y;
  p.x -= above * box.offset;
  p.x -= periods_off(p.x, box.period.x) * box.period.x;
  p.z -= periods_off(p.z, box.period.z) * box.period.z;
  return above;
}

}  // namespace

Particles make_particles(const InitialState& initial, double density, bool rotates) {
  Particles particles;
  const std::size_t all = initial.grains.size();
  particles.real = all;
  particles.state.resize(all);
  particles.load.resize(all);
  particles.id.resize(all);
  particles.body.resize(all);
  for (const InitialGrain& grain : initial.grains) particles.mobile += grain.body == Body::none;
  particles.half.resize(particles.mobile);
  if (rotates) {
    particles.spin.resize(all);
    particles.half_spin.resize(particles.mobile);
  }
  std::size_t mobile = 0;
  std::size_t frozen = particles.mobile;
  for (std::size_t k = 0; k < all; ++k) {
    const InitialGrain& grain = initial.grains[k];
    const std::size_t i = grain.body == Body::none ? mobile++ : frozen++;
    particles.id[i] = static_cast<std::uint32_t>(i);
    place(particles, i, grain, density);
  }
  return particles;
}

void reorder(Particles& particles, const std::vector<std::uint32_t>& order) {
  permute(particles.state, order, particles.real);
  permute(particles.id, order, particles.real);
  permute(particles.load, order, particles.real);
  permute(particles.body, order, particles.real);
  permute(particles.half, order, particles.mobile);
  if (!particles.rotates()) return;
  permute(particles.spin, order, particles.real);
  permute(particles.half_spin, order, particles.mobile);
}

Wrapping wrap(Particles& particles, const Box& box, std::vector<double>* turns) {
  Wrapping done;
  if (turns) turns->assign(particles.real, 0.0);
  for (std::size_t i = 0; i < particles.real; ++i) {
    GrainState& grain = particles.state[i];
    const Vec3 before = grain.position;
    if (box.wedge > 0.0) {
      const double angle = turn_back(particles, i, box.wedge);
      if (turns) (*turns)[i] = angle;
    }
    const double above = shift_back(grain, box);
    if (i >= particles.mobile) continue;
    const double mass = 1.0 / grain.inverse_mass;
    done.displacement += mass * (grain.position - before);
    if (above == 0.0) continue;
    // The velocity half a step before: the force of this step works on the new image already.
    const Vec3 change = -above * box.half_top_velocity;
    const Vec3 before_change = particles.half[i].velocity;
    done.kinetic_energy += mass * dot(change, before_change + 0.5 * change);
    grain.velocity -= above * box.top_velocity;
    particles.half[i].velocity += change;
  }
  return done;
}

}  // namespace grainlaw::dem
