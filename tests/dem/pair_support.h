#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "dem/contact_law.h"
#include "dem/simulation.h"

/// Laws, pairs and simple truths for the tests of contact laws. Units m, d, g: mass and diameter of
/// a mean grain and gravity are 1 (Brewster et al. 2008).
namespace grainlaw::dem::test {

inline constexpr double unit_density = 6.0 / std::numbers::pi;
inline constexpr Hooke hooke{.stiffness = 2e5, .damping = 50.0};
inline constexpr Hertz hertz{.stiffness = 2e5, .damping = 50.0};
inline constexpr GaussianWell well{.strength = 0.6, .width = 0.01};
inline constexpr ReversibleAdhesion adhesion{.largest_force = 40.0, .slope = 4e3};
inline constexpr LiquidBridge liquid{
    .surface_tension = 5.0, .contact_angle = 20.0 * std::numbers::pi / 180.0, .volume = 1e-6};
inline constexpr Sliding sliding{.coefficient = 0.5, .stiffness = 2.0 / 7.0 * 2e5, .damping = 10.0};
inline constexpr StickSlip stick_slip{
    .static_coefficient = 0.6, .coefficient = 0.4, .stiffness = 2.0 / 7.0 * 2e5, .damping = 10.0};

template <class Law>
std::string name(const Law& law) {
  return std::string(law.normal.name) + " + " + std::string(law.cohesion.name) + " + " +
         std::string(law.friction.name);
}

/// Calls use(law) for each of the 24 laws that can be put together.
template <class Use>
void for_each_law(Use&& use) {
  const auto each = [](auto&& call, auto... part) { (call(part), ...); };
  const auto with_friction = [&](auto normal, auto cohesion) {
    each(
        [&](auto friction) {
          use(ContactLaw{normal, cohesion, friction});
        },
        Frictionless{},
        sliding,
        stick_slip);
  };
  const auto with_cohesion = [&](auto normal) {
    each([&](auto cohesion) { with_friction(normal, cohesion); },
         Cohesionless{},
         well,
         adhesion,
         liquid);
  };
  each(with_cohesion, hooke, hertz);
}

/// Reproducible random numbers.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(engine_);
  }
  Vec3 vector(double largest) {
    return {between(-largest, largest), between(-largest, largest), between(-largest, largest)};
  }
  bool chance(double probability) { return between(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 engine_;
};

inline SimulationSetup free_flight(double time_step) {
  SimulationSetup setup;
  setup.density = unit_density;
  setup.dynamics.time_step = time_step;
  return setup;
}

inline double mass_of(double diameter) {
  return diameter * diameter * diameter;
}
inline double reduced_mass(double a, double b) {
  return mass_of(a) * mass_of(b) / (mass_of(a) + mass_of(b));
}

/// Two grains on the x axis, the second at rest at x = (d_1 + d_2)/2 + gap from the first.
inline InitialState pair_on_x(double first, double second, double gap, const Vec3& velocity) {
  InitialState pair;
  pair.grains = {{.velocity = velocity, .diameter = first},
                 {.position = {0.5 * (first + second) + gap, 0.0, 0.0}, .diameter = second}};
  return pair;
}

/// Where the grain with this number is now.
inline std::size_t place_of(const SimulationBase& simulation, std::uint32_t id) {
  std::size_t i = 0;
  while (simulation.particles().id[i] != id) ++i;
  return i;
}
inline Vec3 position_of(const SimulationBase& simulation, std::uint32_t id) {
  return simulation.particles().state[place_of(simulation, id)].position;
}
inline Vec3 velocity_of(const SimulationBase& simulation, std::uint32_t id) {
  return simulation.velocity(place_of(simulation, id));
}
/// R omega.
inline Vec3 spin_of(const SimulationBase& simulation, std::uint32_t id) {
  return simulation.particles().rotates() ? simulation.spin(place_of(simulation, id)) : Vec3{};
}

/// Steps until the pairs act no longer; returns how many steps they did.
inline long pass_contact(auto& simulation) {
  long acted = 0;
  while (simulation.acting_pairs() == 0) simulation.step();
  for (; simulation.acting_pairs() > 0; ++acted) simulation.step();
  return acted;
}

/// Mean and standard deviation over the start phases of a head-on collision.
struct Restitution {
  double mean = 0.0;
  double spread = 0.0;
};
template <class Law>
Restitution restitution(const Law& law, double speed, double time_step, int phases) {
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < phases; ++k) {
    const double gap = (k + 0.5) / phases * speed * time_step;
    Simulation<Law> pair(law, free_flight(time_step), pair_on_x(1.0, 1.0, gap, {speed, 0.0, 0.0}));
    pass_contact(pair);
    const double value = (velocity_of(pair, 1).x - velocity_of(pair, 0).x) / speed;
    sum += value, squares += value * value;
  }
  const double mean = sum / phases;
  return {mean, std::sqrt(std::max(0.0, squares / phases - mean * mean))};
}

/// Head-on collision of Brewster et al. 2008, eq. 2, integrated directly (Runge-Kutta, fourth
/// order) from overlap 0 back to overlap 0.
struct HeadOn {
  double restitution = 0.0;
  double duration = 0.0;
};
template <class Normal>
HeadOn head_on(const Normal& law, double mass, double radius_sum, double speed, double step) {
  struct State {
    double overlap, velocity;  // velocity of approach
  };
  const auto rate = [&](const State& s) -> State {
    Contact c;
    c.overlap = std::max(s.overlap, 0.0);
    c.normal_velocity = -s.velocity;
    c.reduced_mass = mass;
    c.radius_sum = radius_sum;
    return {s.velocity, -law.force(c) / mass};
  };
  const auto moved = [](const State& s, double h, const State& r) -> State {
    return {s.overlap + h * r.overlap, s.velocity + h * r.velocity};
  };
  State s{0.0, speed};
  for (long n = 0;; ++n) {
    const State a = rate(s), b = rate(moved(s, 0.5 * step, a)), c = rate(moved(s, 0.5 * step, b)),
                d = rate(moved(s, step, c));
    const State next{
        s.overlap + step / 6.0 * (a.overlap + 2.0 * (b.overlap + c.overlap) + d.overlap),
        s.velocity + step / 6.0 * (a.velocity + 2.0 * (b.velocity + c.velocity) + d.velocity)};
    if (next.overlap <= 0.0) {
      const double part = s.overlap / (s.overlap - next.overlap);
      return {-(s.velocity + part * (next.velocity - s.velocity)) / speed,
              (static_cast<double>(n) + part) * step};
    }
    s = next;
  }
}

}  // namespace grainlaw::dem::test
