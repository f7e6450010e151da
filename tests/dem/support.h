#pragma once

#include <cmath>
#include <numbers>

#include "dem/contact_law.h"
#include "dem/packing.h"
#include "dem/simulation.h"

namespace grainlaw::dem::test {

/// The grain of Brewster et al. 2008 in units of m, d, g: k_n = 2e5, gamma_n = 50, k_t = 2/7 k_n.
inline constexpr Hooke stiff{.stiffness = 2e5, .damping = 50.0};
inline constexpr Hooke soft{.stiffness = 2e4, .damping = 16.26};

inline Sliding sliding(double coefficient, double normal_stiffness) {
  return {.coefficient = coefficient, .stiffness = 2.0 / 7.0 * normal_stiffness, .damping = 0.0};
}

inline ContactLaw<Hooke, Cohesionless, Frictionless> smooth(const Hooke& normal) {
  return {normal, {}, {}};
}
inline ContactLaw<Hooke, Cohesionless, Sliding> rough(const Hooke& normal, double coefficient) {
  return {normal, {}, sliding(coefficient, normal.stiffness)};
}

inline SimulationSetup free_space(double time_step) {
  SimulationSetup setup;
  setup.dynamics.time_step = time_step;
  return setup;
}

inline double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

/// A small chute that runs in seconds: 3 d deep by default on a base of 4 d by 4 d.
inline Scene small_chute(double inclination_degrees, int grains = 55) {
  Scene scene;
  scene.name = "small chute";
  scene.normal = soft;
  scene.friction = sliding(0.5, soft.stiffness);
  scene.geometry.inclination = radians(inclination_degrees);
  scene.geometry.length = 4.0;
  scene.geometry.width = 4.0;
  scene.geometry.grains = grains;
  return scene;
}

/// A gas of rough grains without gravity, periodic in all directions, with random velocities.
struct Gas {
  SimulationSetup setup;
  InitialState initial;
};
inline Gas gas(double period, std::size_t grains, double speed, double time_step) {
  Gas result;
  result.setup = free_space(time_step);
  result.setup.box.period = {period, period, period};
  result.initial.position = random_packing(result.setup.box, grains, 1.0, 7);
  // Directions without a pattern, from multiples of irrational numbers.
  for (std::size_t k = 1; k <= grains; ++k) {
    const auto turn = [&](double irrational) {
      return std::sin(2.0 * std::numbers::pi * irrational * static_cast<double>(k));
    };
    result.initial.velocity.push_back(speed * Vec3{turn(std::numbers::sqrt2),
                                                   turn(std::numbers::sqrt3),
                                                   turn(std::numbers::phi)});
  }
  return result;
}

template <class Law>
Vec3 momentum(const Simulation<Law>& simulation) {
  Vec3 sum;
  for (std::size_t i = 0; i < simulation.particles().mobile; ++i) sum += simulation.velocity(i);
  return simulation.setup().dynamics.mass * sum;
}

}  // namespace grainlaw::dem::test
