#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dem/contact_law.h"
#include "dem/flow_setup.h"
#include "dem/packing.h"
#include "dem/simulation.h"

namespace grainlaw::dem::test {

/// The grain of Brewster et al. 2008 in units of m, d, g: k_n = 2e5, gamma_n = 50, k_t = 2/7 k_n.
inline constexpr Hooke stiff{.stiffness = 2e5, .damping = 50.0};
inline constexpr Hooke soft{.stiffness = 2e4, .damping = 16.26};

inline Sliding sliding(double coefficient, double normal_stiffness, double damping = 0.0) {
  return {
      .coefficient = coefficient, .stiffness = 2.0 / 7.0 * normal_stiffness, .damping = damping};
}

inline ContactLaw<Hooke, Cohesionless, Frictionless> smooth(const Hooke& normal) {
  return {normal, {}, {}};
}
inline ContactLaw<Hooke, Cohesionless, Sliding> rough(const Hooke& normal, double coefficient) {
  return {normal, {}, sliding(coefficient, normal.stiffness)};
}

/// Of grains of mass 1 and diameter 1.
inline constexpr double unit_density = 6.0 / std::numbers::pi;

inline SimulationSetup free_space(double time_step) {
  SimulationSetup setup;
  setup.density = unit_density;
  setup.dynamics.time_step = time_step;
  return setup;
}

inline double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

/// Numbers without a pattern in (-1, 1), from multiples of irrational numbers.
inline Vec3 scatter(std::size_t k) {
  const auto turn = [&](double irrational) {
    return std::sin(2.0 * std::numbers::pi * irrational * (static_cast<double>(k) + 1.0));
  };
  return {turn(std::numbers::sqrt2), turn(std::numbers::sqrt3), turn(std::numbers::phi)};
}

/// A gas with random velocities in a box that is periodic in all directions; its momentum is 0.
inline InitialState gas(double period, std::size_t grains, double speed, std::size_t seed = 0) {
  InitialState gas;
  gas.box.period = {period, period, period};
  const std::vector<double> sizes(grains, 1.0);
  Vec3 mean;
  for (const Vec3& place : random_packing(gas.box, sizes, 7 + seed)) {
    const std::size_t k = gas.grains.size();
    gas.grains.push_back({.position = place, .velocity = speed * scatter(k + 1000 * seed)});
    mean += 1.0 / static_cast<double>(grains) * gas.grains.back().velocity;
  }
  for (InitialGrain& grain : gas.grains) grain.velocity -= mean;
  return gas;
}

/// A small chute that runs in seconds: 3 d deep by default on a base of 4 d by 4 d.
inline Scene small_chute(double inclination_degrees, int grains = 55) {
  Scene scene;
  scene.name = "small chute";
  scene.normal = soft;
  scene.friction = sliding(0.5, soft.stiffness);
  Chute chute;
  chute.inclination = radians(inclination_degrees);
  chute.length = 4.0;
  chute.width = 4.0;
  chute.grains = grains;
  scene.geometry = chute;
  return scene;
}

/// The same grains in another geometry.
inline Scene small_scene(const Geometry& geometry) {
  Scene scene = small_chute(0.0);
  scene.name = "small scene";
  scene.geometry = geometry;
  return scene;
}
inline Scene small_shear(std::optional<double> pressure, int grains = 80, double fraction = 0.58) {
  SimpleShear box;
  box.shear_rate = 1.0;
  box.pressure = pressure;
  box.grains = grains;
  box.volume_fraction = fraction;
  return small_scene(box);
}
inline Scene small_plane_shear(std::optional<double> load) {
  PlaneShear shear;
  shear.velocity = 2.0;
  shear.load = load;
  shear.length = shear.width = 4.0;
  shear.grains = 70;
  return small_scene(shear);
}
/// Strong enough to flow: the largest stress is 0.6 of the pressure.
inline Scene small_force_box() {
  BodyForceBox box;
  box.amplitude = 8.0;
  box.pressure = 10.0;
  box.length = box.width = 4.0;
  box.grains = 80;
  return small_scene(box);
}
/// A quarter of a ring 5 d wide.
inline Scene small_ring() {
  SplitBottom cell;
  cell.inner_radius = 3.0;
  cell.split_radius = 5.5;
  cell.outer_radius = 8.0;
  cell.wedge = 0.5 * std::numbers::pi;
  cell.rotation_rate = 0.3;
  cell.grains = 130;
  return small_scene(cell);
}

/// The scene with another law, at a step of 1/steps_per_contact of its shortest contact time.
template <class Law>
Scene with(Scene scene, const Law& law, double steps_per_contact) {
  scene.normal = law.normal;
  scene.cohesion = law.cohesion;
  scene.friction = law.friction;
  scene.time_step = shortest_contact_time(scene) / steps_per_contact;
  return scene;
}

/// The flow of a scene from its packing. The law is that of the scene, as a type.
template <class Law>
Simulation<Law> flow(const Scene& scene, const Law& law, int threads = 1) {
  const InitialState start = initial_state(scene);
  SimulationSetup setup = flow_setup(scene, start);
  setup.threads = threads;
  return Simulation<Law>(law, setup, start);
}

/// Of the mobile grains, by their numbers.
struct Motions {
  std::vector<Vec3> position;
  std::vector<Vec3> velocity;
  std::vector<Vec3> spin;
};
inline Motions motions(const SimulationBase& simulation) {
  const Particles& particles = simulation.particles();
  const std::vector<Vec3> none(particles.mobile);
  Motions motions{none, none, none};
  for (std::size_t i = 0; i < particles.mobile; ++i) {
    const std::uint32_t id = particles.id[i];
    motions.position[id] = particles.state[i].position;
    motions.velocity[id] = simulation.velocity(i);
    if (particles.rotates()) motions.spin[id] = simulation.spin(i);
  }
  return motions;
}

inline Vec3 momentum(const SimulationBase& simulation) {
  Vec3 sum;
  for (std::size_t i = 0; i < simulation.particles().mobile; ++i) {
    sum += 1.0 / simulation.particles().state[i].inverse_mass * simulation.velocity(i);
  }
  return sum;
}

template <class Law>
void run_until(Simulation<Law>& simulation, double time) {
  while (simulation.time() < time) simulation.step();
}

}  // namespace grainlaw::dem::test
