#include "dem/simulation.h"

#include <fmt/format.h>

#include <cmath>

#include "dem/run.h"

namespace grainlaw::dem {
namespace {

std::string at(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

template <class T>
void permute(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  std::vector<T> old(values.size());
  old.swap(values);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = old[order[i]];
}

}  // namespace

void report_lost_grain(const Particles& particles,
                       const SimulationSetup& setup,
                       const Motion& motion,
                       long step) {
  const double limit = 0.5 * setup.diameter / setup.dynamics.time_step;
  std::size_t worst = 0;
  const auto lost = [&](std::size_t i) {
    const double speed = length(particles.half_velocity[i]);
    return !(speed < limit && particles.state[i].position.z >= setup.lowest_height);
  };
  while (worst + 1 < particles.mobile && !lost(worst)) ++worst;
  const Vec3& position = particles.state[worst].position;
  const double speed = length(particles.half_velocity[worst]);
  if (std::isnan(motion.fastest) || std::isnan(speed)) {
    throw RunError(
        fmt::format("step {}: grain {} at {} has no finite velocity; try a smaller time_step",
                    step,
                    particles.id[worst],
                    at(position)));
  }
  throw RunError(
      fmt::format("step {}: grain {} is lost at {} with speed {:.4g}; grains stay above z = {:.4g} "
                  "and move less "
                  "than half a diameter in a step (speed < {:.4g}); try a smaller time_step or a "
                  "stiffer contact",
                  step,
                  particles.id[worst],
                  at(position),
                  speed,
                  setup.lowest_height,
                  limit));
}

void report_overlap(const Particles& particles,
                    const SimulationSetup& setup,
                    const NeighbourList& list,
                    long step) {
  const auto shifts = setup.box.image_shifts();
  double closest = INFINITY;
  std::size_t a = 0, b = 0;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    for (auto pair = list.row_begin(i); pair < list.row_begin(i + 1); ++pair) {
      const Partner partner = list.partners()[pair];
      const Vec3 there = particles.state[partner.grain()].position + shifts[partner.image()];
      const double distance = length(particles.state[i].position - there);
      if (distance >= closest) continue;
      closest = distance;
      a = i;
      b = partner.grain();
    }
  }
  throw RunError(
      fmt::format("step {}: grains {} and {}{} overlap by {:.3f} of the radius near {}, more than "
                  "max_overlap = "
                  "{}; stiffen the contact, or raise max_overlap if the scene is meant to be soft",
                  step,
                  particles.id[a],
                  particles.id[b],
                  b < particles.mobile ? "" : " (frozen)",
                  2.0 * (setup.diameter - closest) / setup.diameter,
                  at(particles.state[a].position),
                  setup.max_overlap));
}

Particles make_particles(const InitialState& initial, bool rotates) {
  Particles particles;
  const std::size_t mobile = initial.position.size();
  const std::size_t all = mobile + initial.frozen.size();
  particles.mobile = mobile;
  particles.state.resize(all);
  particles.load.resize(all);
  particles.id.resize(all);
  particles.half_velocity.resize(mobile);
  particles.last_rate.resize(mobile);
  if (rotates) {
    particles.spin.resize(all);
    particles.half_spin.resize(mobile);
    particles.last_spin_rate.resize(mobile);
  }
  for (std::size_t i = 0; i < all; ++i) {
    particles.id[i] = static_cast<std::uint32_t>(i);
    particles.state[i].position = i < mobile ? initial.position[i] : initial.frozen[i - mobile];
  }
  for (std::size_t i = 0; i < initial.velocity.size(); ++i) {
    particles.state[i].velocity = initial.velocity[i];
  }
  for (std::size_t i = 0; rotates && i < initial.spin.size(); ++i) {
    static_cast<Vec3&>(particles.spin[i]) = initial.spin[i];
  }
  return particles;
}

void reorder(Particles& particles, const std::vector<std::uint32_t>& order) {
  permute(particles.state, order);
  permute(particles.id, order);
  permute(particles.half_velocity, order);
  permute(particles.last_rate, order);
  permute(particles.load, order);
  if (particles.spin.empty()) return;
  permute(particles.spin, order);
  permute(particles.half_spin, order);
  permute(particles.last_spin_rate, order);
}

Vec3 wrap(Particles& particles, const Box& box) {
  Vec3 sum;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const Vec3 shift = box.wrapping(particles.state[i].position);
    particles.state[i].position += shift;
    sum += shift;
  }
  return sum;
}

Vec3 middle_velocity(const Particles& particles) {
  const bool some_frozen = particles.mobile < particles.size();
  Vec3 low = some_frozen || particles.mobile == 0 ? Vec3{} : particles.half_velocity.front();
  Vec3 high = low;
  for (const Vec3& v : particles.half_velocity) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return 0.5 * (low + high);
}

Vec3 position_sum(const Particles& particles) {
  Vec3 sum;
  for (std::size_t i = 0; i < particles.mobile; ++i) sum += particles.state[i].position;
  return sum;
}

}  // namespace grainlaw::dem
