#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "dem/run_error.h"
#include "dem/simulation.h"

namespace grainlaw::dem {
namespace {

std::string at(const Vec3& p) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

bool inside(const Vec3& p, const Vec3& low, const Vec3& high) {
  return p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y &&
         p.z <= high.z;
}

bool finite(const Vec3& v) {
  return std::isfinite(v.x + v.y + v.z);
}

}  // namespace

void report_lost_grain(const Particles& particles, const SimulationSetup& setup, long step) {
  const double dt = setup.dynamics.time_step;
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const GrainState& grain = particles.state[i];
    if (!finite(particles.half[i].velocity) || !finite(grain.position)) {
      throw RunError(
          fmt::format("step {}: grain {} at {} has no finite velocity; try a smaller time step",
                      step,
                      particles.id[i],
                      at(grain.position)));
    }
    if (inside(grain.position, setup.lowest, setup.highest)) continue;
    throw RunError(fmt::format(
        "step {}: grain {} is lost at {} with speed {:.4g}; grains stay between {} and {}; try a "
        "smaller time step or a stiffer contact",
        step,
        particles.id[i],
        at(grain.position),
        length(particles.half[i].velocity),
        at(setup.lowest),
        at(setup.highest)));
  }
  std::size_t worst = 0;
  const auto speed = [&](std::size_t i) { return length(particles.half[i].velocity); };
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    if (speed(i) > speed(worst)) worst = i;
  }
  throw RunError(fmt::format(
      "step {}: grain {} at {} has speed {:.4g} and moves {:.3g} in a step, more than a radius "
      "against the mean flow; try a smaller time step or a stiffer contact",
      step,
      particles.id[worst],
      at(particles.state[worst].position),
      speed(worst),
      speed(worst) * dt));
}

void report_overlap(const Particles& particles,
                    const ContactSetting& contacts,
                    const std::vector<Strip>& strips,
                    const SimulationSetup& setup,
                    long step) {
  double largest = -1.0;
  std::size_t a = 0, b = 0;
  for (const Strip& strip : strips) {
    for (std::size_t k = 0; k < strip.acting.count; ++k) {
      const Partner partner{strip.acting.partner[k]};
      const GrainState& first = particles.state[strip.acting.first[k]];
      const GrainState& second = particles.state[partner.grain()];
      const Vec3 there = second.position + contacts.shifts[partner.image()].position;
      const double overlap = first.radius + second.radius - length(first.position - there);
      const double smaller =
          second.radius > 0.0 ? std::min(first.radius, second.radius) : first.radius;
      if (overlap / smaller <= largest) continue;
      largest = overlap / smaller;
      a = strip.acting.first[k];
      b = partner.grain();
    }
  }
  const bool wall = particles.id[b] >= first_wall_id;
  const std::string partner =
      wall ? fmt::format("wall {}", particles.id[b] - first_wall_id)
           : fmt::format("grain {}{}", particles.id[b], b < particles.mobile ? "" : " (frozen)");
  throw RunError(fmt::format(
      "step {}: grain {} and {} overlap by {:.3f} of the smaller radius near {}, more than "
      "max_overlap = {}; stiffen the contact, or raise max_overlap if the scene is meant to be "
      "soft",
      step,
      particles.id[a],
      partner,
      largest,
      at(particles.state[a].position),
      setup.max_overlap));
}

}  // namespace grainlaw::dem
