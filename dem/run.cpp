#include "dem/run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "dem/binary_collision.h"
#include "dem/contact_law.h"
#include "dem/flow_run.h"
#include "dem/flow_setup.h"
#include "dem/packing.h"

namespace grainlaw::dem {
namespace {

/// Calls use(law) with the law of the scene as one type: the only place where laws are chosen.
template <class Use>
auto with_law(const Scene& scene, Use&& use) {
  return std::visit(
      [&](auto normal, auto cohesion, auto friction) {
        return use(ContactLaw{normal, cohesion, friction});
      },
      scene.normal,
      scene.cohesion,
      scene.friction);
}

double attraction(const Scene& scene) {
  return std::visit(
      [&](const auto& law) {
        if constexpr (std::decay_t<decltype(law)>::attracts)
          return law.largest_attraction(0.5 * scene.grains.diameter);
        else
          return 0.0;
      },
      scene.cohesion);
}

/// What is known of a run that was stopped before anything flowed.
LocalData not_begun(const Scene& scene, double wall_seconds) {
  LocalData data;
  data.name = scene.name;
  data.conditions = conditions(scene);
  data.window.reason = "short: stopped before the flow started";
  data.summary.time_step = time_step(scene);
  data.summary.contact_time = shortest_contact_time(scene);
  data.summary.wall_seconds = wall_seconds;
  return data;
}

}  // namespace

ChuteConditions conditions(const Scene& scene) {
  ChuteConditions c{
      .geometry = std::string(kind(scene.geometry)),
      .grain_diameter = scene.grains.diameter,
      .grain_density = scene.grains.density(),
      .stiffness = std::visit([](const auto& law) { return law.stiffness; }, scene.normal),
      .contact_friction = contact_friction(scene),
      .attraction = attraction(scene)};
  if (const auto* chute = std::get_if<Chute>(&scene.geometry)) {
    c.inclination = chute->inclination;
    if (!chute->tilts.empty()) {
      c.tilts = {{0.0, chute->inclination}};
      c.tilts.insert(c.tilts.end(), chute->tilts.begin(), chute->tilts.end());
    }
    c.gravity = chute->gravity;
    c.mass_per_area = mass_per_area(scene.grains, *chute);
    c.base = recipe(chute->base);
  } else if (const auto* box = std::get_if<SimpleShear>(&scene.geometry)) {
    c.shear_rate = box->shear_rate;
  }
  return c;
}

double contact_friction(const Scene& scene) {
  return std::visit(
      [](const auto& law) {
        if constexpr (std::decay_t<decltype(law)>::rotates)
          return law.coefficient;
        else
          return 0.0;
      },
      scene.friction);
}

InitialState present_state(const SimulationBase& simulation) {
  const Particles& particles = simulation.particles();
  InitialState state{.box = simulation.box(), .grains = std::vector<InitialGrain>(particles.real)};
  for (std::size_t i = 0; i < particles.real; ++i) {
    const GrainState& grain = particles.state[i];
    state.grains[particles.id[i]] = {.position = grain.position,
                                     .velocity = grain.velocity,
                                     .diameter = 2.0 * grain.radius,
                                     .body = particles.body[i]};
  }
  return state;
}

Snapshot snapshot(const SimulationBase& simulation) {
  const Particles& particles = simulation.particles();
  Snapshot taken{.time = simulation.time(), .state = present_state(simulation)};
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    InitialGrain& grain = taken.state.grains[particles.id[i]];
    grain.velocity = simulation.velocity(i);
    if (particles.rotates())
      grain.rotation = (1.0 / particles.state[i].radius) * simulation.spin(i);
  }
  return taken;
}

LocalData run(const Scene& scene, const RunOptions& options) {
  validate(scene);
  const Stopwatch clock;
  try {
    return with_law(scene, [&](const auto& law) { return FlowRun{scene, law, options}.run(); });
  } catch (const PackingStopped&) {
    if (options.save) options.save(options.resume ? *options.resume : Checkpoint{});
    return not_begun(scene, clock.seconds());
  }
}

double measure_step_seconds(const Scene& scene) {
  validate(scene);
  return with_law(scene, [&](const auto& law) {
    const InitialState packing = initial_state(scene);
    Simulation simulation{law, flow_setup(scene, packing), packing};
    const auto seconds_per_step = [&] {
      constexpr double shortest = 0.2;  // [s]
      const Stopwatch clock;
      long steps = 0;
      for (; steps < 100 || clock.seconds() < shortest; ++steps) simulation.step();
      return clock.seconds() / static_cast<double>(steps);
    };
    seconds_per_step();  // the packing has hardly any contacts: let it fall together first
    return seconds_per_step();
  });
}

}  // namespace grainlaw::dem
