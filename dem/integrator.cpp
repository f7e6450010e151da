#include "dem/integrator.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

// m R^2 / I of a solid sphere: d(R omega)/dt = 5/2 (torque / R) / m.
constexpr double inertia_ratio = 2.5;

Row4 row(double x, double y, double z) {
  alignas(32) const double values[4] = {x, y, z, 0.0};
  return load_row4(values);
}
Row4 row(const Vec3& v) {
  return row(v.x, v.y, v.z);
}
Vec3 vector(const Row4& r) {
  return {r[0], r[1], r[2]};
}

// A field gives the acceleration at a position; `uniform` where that does not matter.
struct UniformField {
  static constexpr bool uniform = true;
  Row4 value;
  explicit UniformField(const Uniform& f) : value(row(f.acceleration)) {}
  Row4 at(const Row4&) const { return value; }
};

struct AffineField {
  static constexpr bool uniform = false;
  Row4 slope;
  Affine box;
  explicit AffineField(const Affine& f)
      : slope(row(
            f.shear_rate * f.strain_rate, f.strain_rate_rate + f.strain_rate * f.strain_rate, 0.0)),
        box(f) {}
  Row4 at(const Row4& position) const { return (position[1] - box.middle) * slope; }
  double strain_rate() const { return box.strain_rate; }
  double middle() const { return box.middle; }
};

struct SineField {
  static constexpr bool uniform = false;
  Sine sine;
  Row4 along_x = row(1.0, 0.0, 0.0);
  AffineField affine;
  explicit SineField(const Sine& f)
      : sine(f), affine(Affine{0.0, f.strain_rate, f.strain_rate_rate, f.middle}) {}
  double strain_rate() const { return affine.strain_rate(); }
  double middle() const { return affine.middle(); }
  Row4 at(const Row4& position) const {
    return affine.at(position) +
           (sine.amplitude * (std::sin(sine.wave_number * position[1]) - sine.mean)) * along_x;
  }
};

template <class Use>
auto with_field(const Dynamics& dynamics, Use&& use) {
  if (const auto* uniform = std::get_if<Uniform>(&dynamics.field))
    return use(UniformField(*uniform));
  if (const auto* sine = std::get_if<Sine>(&dynamics.field)) return use(SineField(*sine));
  return use(AffineField(std::get<Affine>(dynamics.field)));
}

/// Leapfrog of one vector: what it needs is read when it is made and written by store(), so that
/// the records of a grain are all read before any is written (a load close behind a store to
/// another record at the same place in its page would wait for it). The fourth element of `rate` is
/// 0, so what stands beside the velocity stays what it is.
struct Leap {
  Row4 velocity;
  Row4 predicted;
  Row4 rate;

  Leap(const HalfStep& half, const Row4& new_rate, double dt)
      : velocity(load_row4(&half.velocity.x) + dt * new_rate),
        predicted(velocity + dt * (new_rate - 0.5 * load_row4(&half.last_rate.x))),
        rate(new_rate) {}

  void write(HalfStep& half, double* prediction) const {
    store(velocity, &half.velocity.x);
    store(rate, &half.last_rate.x);
    store(predicted, prediction);
  }
};

/// Translation and rotation in one pass: a grain's records come from memory once.
template <bool rotates, class Field>
Motion advance_in(const Field& field,
                  Particles& particles,
                  double dt,
                  const Frame& frame,
                  std::size_t begin,
                  std::size_t end) {
  const Row4 way = row(dt, dt, dt);
  const Row4 zero = row(0.0, 0.0, 0.0);
  const Row4 frame_velocity = row(frame.velocity, 0.0, 0.0);
  const Row4 frame_gradient = row(frame.gradient, 0.0, 0.0);
  Row4 fastest = zero;
  Row4 lowest = row(INFINITY, INFINITY, INFINITY);
  Row4 highest = -lowest;
  Row4 sum = zero;  // carries any NaN, which comparisons would drop
  double work = 0.0;
  double kinetic_yy = 0.0;
  const auto other_axis = frame.along_y ? 1 : 2;
  for (std::size_t i = begin; i < end; ++i) {
    GrainState& grain = particles.state[i];
    GrainLoad& load = particles.load[i];
    HalfStep& half = particles.half[i];
    const double inverse_mass = grain.inverse_mass;
    const Row4 position = load_row4(&grain.position.x);
    const Row4 external = field.at(position);
    const Leap leap(half, inverse_mass * load_row4(&load.force.x) + external, dt);
    if constexpr (!Field::uniform) {
      const Vec3 twice_mean = 2.0 * half.velocity + dt * vector(leap.rate);
      work += 0.5 * dt * dot(twice_mean, vector(external)) / inverse_mass;
      const double c = leap.velocity[1] - field.strain_rate() * (position[1] - field.middle());
      kinetic_yy += c * c / inverse_mass;
    }
    if constexpr (rotates) {
      const Row4 spin_rate = (inertia_ratio * inverse_mass) * load_row4(&load.torque.x);
      const Leap turn(particles.half_spin[i], spin_rate, dt);
      turn.write(particles.half_spin[i], &particles.spin[i].velocity.x);
      store(zero, &load.torque.x);
    }
    const Row4 next = position + way * leap.velocity;
    leap.write(half, &grain.velocity.x);
    store(next, &grain.position.x);
    store(zero, &load.force.x);
    const double at = next[other_axis];
    const Row4 relative = leap.velocity - (frame_velocity + at * frame_gradient);
    fastest = max(fastest, max(relative, -relative));
    lowest = min(lowest, next);
    highest = max(highest, next);
    sum += leap.velocity;
  }
  return {vector(fastest),
          vector(lowest),
          vector(highest),
          work,
          kinetic_yy,
          std::isfinite(sum[0] + sum[1] + sum[2])};
}

Vec3 acceleration(const Particles& particles, std::size_t i, const Dynamics& dynamics) {
  return particles.state[i].inverse_mass * particles.load[i].force +
         field_acceleration(dynamics, particles.state[i].position);
}

Vec3 spin_acceleration(const Particles& particles, std::size_t i) {
  return (inertia_ratio * particles.state[i].inverse_mass) * particles.load[i].torque;
}

}  // namespace

Motion& Motion::operator+=(const Motion& b) {
  const auto each = [](Vec3& a, const Vec3& c, auto pick) {
    a = {pick(a.x, c.x), pick(a.y, c.y), pick(a.z, c.z)};
  };
  const auto larger = [](double a, double c) { return std::max(a, c); };
  const auto smaller = [](double a, double c) { return std::min(a, c); };
  each(fastest, b.fastest, larger);
  each(lowest, b.lowest, smaller);
  each(highest, b.highest, larger);
  field_work += b.field_work;
  kinetic_yy += b.kinetic_yy;
  finite = finite && b.finite;
  return *this;
}

Motion advance(Particles& particles,
               const Dynamics& dynamics,
               const Frame& frame,
               std::size_t begin,
               std::size_t end) {
  return with_field(dynamics, [&](const auto& field) {
    const double dt = dynamics.time_step;
    return particles.rotates() ? advance_in<true>(field, particles, dt, frame, begin, end)
                               : advance_in<false>(field, particles, dt, frame, begin, end);
  });
}

void balance(Dynamics& dynamics, const Particles& particles) {
  auto* sine = std::get_if<Sine>(&dynamics.field);
  if (!sine) return;
  double mass = 0.0, sum = 0.0;  // in the order of the grains, whatever the threads
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    mass += 1.0 / grain.inverse_mass;
    sum += std::sin(sine->wave_number * grain.position.y) / grain.inverse_mass;
  }
  sine->mean = mass > 0.0 ? sum / mass : 0.0;
}

Vec3 field_acceleration(const Dynamics& dynamics, const Vec3& position) {
  return with_field(dynamics, [&](const auto& field) { return vector(field.at(row(position))); });
}

Vec3 velocity(const Particles& particles, std::size_t i, const Dynamics& dynamics) {
  return particles.half[i].velocity +
         0.5 * dynamics.time_step * acceleration(particles, i, dynamics);
}

Vec3 spin(const Particles& particles, std::size_t i, const Dynamics& dynamics) {
  return particles.half_spin[i].velocity +
         0.5 * dynamics.time_step * spin_acceleration(particles, i);
}

void restart_half_step(Particles& particles, const Dynamics& dynamics) {
  const double half = 0.5 * dynamics.time_step;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const Vec3 rate = acceleration(particles, i, dynamics);
    particles.half[i].velocity = particles.state[i].velocity - half * rate;
    particles.half[i].last_rate = rate;
    if (!particles.rotates()) continue;
    const Vec3 spin_rate = spin_acceleration(particles, i);
    particles.half_spin[i].velocity = particles.spin[i].velocity - half * spin_rate;
    particles.half_spin[i].last_rate = spin_rate;
  }
}

double kinetic_energy(const Particles& particles, const Dynamics& dynamics) {
  double twice = 0.0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    double speed2 = square(velocity(particles, i, dynamics));
    if (particles.rotates()) speed2 += square(spin(particles, i, dynamics)) / inertia_ratio;
    twice += speed2 / particles.state[i].inverse_mass;
  }
  return 0.5 * twice;
}

}  // namespace grainlaw::dem
