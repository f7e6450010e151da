#pragma once

#include <cmath>
#include <numbers>

#include "dem/simulation.h"

namespace grainlaw::dem {

/// Equal grains of a binary collision.
struct CollidingGrains {
  double mass = 1.0;      ///< [mass]
  double diameter = 1.0;  ///< [length]
};

/// Restitution of a head-on collision as the integrator delivers it at this step, averaged over
/// the phase of the step at which the contact begins (evenly spread). A linear law does not care
/// for the closing speed [length/time]. Of a law without cohesion.
template <class Law>
double mean_restitution(const Law& law,
                        const CollidingGrains& grains,
                        double speed,
                        double time_step) {
  static_assert(!Law::attracts);
  constexpr int phases = 64;
  SimulationSetup setup;
  setup.density = 6.0 * grains.mass / (std::numbers::pi * std::pow(grains.diameter, 3));
  setup.dynamics.time_step = time_step;
  setup.max_overlap = 2.0;  // a probe: the guard of a scene is for its own grains
  double sum = 0.0;
  for (int k = 0; k < phases; ++k) {
    const double gap = (k + 0.5) / phases * speed * time_step;
    InitialState approaching;
    approaching.grains = {
        {.position = {}, .velocity = {0.5 * speed, 0.0, 0.0}, .diameter = grains.diameter},
        {.position = {grains.diameter + gap, 0.0, 0.0},
         .velocity = {-0.5 * speed, 0.0, 0.0},
         .diameter = grains.diameter}};
    Simulation<Law> pair(law, setup, approaching);
    do {
      pair.step();
    } while (pair.acting_pairs() > 0 || pair.time() < time_step * 1.5);
    sum += length(pair.velocity(0) - pair.velocity(1)) / speed;
  }
  return sum / phases;
}

}  // namespace grainlaw::dem
