#pragma once

#include "dem/simulation.h"

namespace grainlaw::dem {

/// Equal grains of a binary collision.
struct CollidingGrains {
  double mass = 1.0;      ///< [mass]
  double diameter = 1.0;  ///< [length]
};

/// Restitution of a head-on collision as the integrator delivers it at this step, averaged over
/// the phase of the step at which the contact begins (evenly spread). The closing speed moves the
/// grains by about 1e-3 d in the contact; a linear law does not care.
template <class Law>
double mean_restitution(const Law& law, const CollidingGrains& grains, double time_step) {
  constexpr int phases = 64;
  const double contact_time = law.normal.contact_time(0.5 * grains.mass);
  const double speed = 1e-3 * grains.diameter / contact_time;
  SimulationSetup setup;
  setup.diameter = grains.diameter;
  setup.dynamics.mass = grains.mass;
  setup.dynamics.time_step = time_step;
  double sum = 0.0;
  for (int k = 0; k < phases; ++k) {
    const double gap = (k + 0.5) / phases * speed * time_step;
    InitialState approaching;
    approaching.position = {{}, {grains.diameter + gap, 0.0, 0.0}};
    approaching.velocity = {{0.5 * speed, 0.0, 0.0}, {-0.5 * speed, 0.0, 0.0}};
    Simulation<Law> pair(law, setup, approaching);
    do {
      pair.step();
    } while (pair.touching_pairs() > 0 || pair.time() < time_step * 1.5);
    sum += length(pair.velocity(0) - pair.velocity(1)) / speed;
  }
  return sum / phases;
}

}  // namespace grainlaw::dem
