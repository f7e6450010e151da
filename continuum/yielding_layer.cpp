#include "continuum/yielding_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace grainlaw::continuum {
namespace {

/// The lowest mode of a layer of mass M has the wave number pi / (2 M): frequency w = c pi / (2 M),
/// damping t_e w^2, critical at t_e w = 2.
double critical_wave_speed(double mass, double elastic_time) {
  return 4.0 * mass / (std::numbers::pi * elastic_time);
}

/// In sqrt(g d): below it walls hold grains by less than their full friction, so what rests at them
/// creeps by about this.
constexpr double sticking_speed = 1e-6;

constexpr std::size_t velocity_of(std::size_t cell) {
  return 2 * cell;
}
constexpr std::size_t stress_of(std::size_t face) {
  return 2 * face + 1;
}

}  // namespace

YieldingLayer::YieldingLayer(DiscreteLayer discrete, double elastic_time)
    : TransientSystem(std::move(discrete)), elastic_time_(elastic_time) {
  const double speed = critical_wave_speed(this->discrete().layer().mass, elastic_time);
  wave_speed_squared_ = speed * speed;
  for (std::size_t k = 0; k < cells(); ++k)
    yielding_.emplace_back(curve(k), this->discrete().layer().driving_stress(grid().face[k]));
}

double YieldingLayer::plastic_rate(double stress, std::size_t face) const {
  try {
    return yielding_[face].rate(stress);
  } catch (const StateError& error) {
    throw StateError(fmt::format("the stress in {} {}", face_name(face), error.what()));
  }
}

double YieldingLayer::stress_rate(std::span<const double> y, std::size_t face) const {
  const double gradient =
      face + 1 < cells() ? (y[velocity_of(face)] - y[velocity_of(face + 1)]) / grid().distance[face]
                         : discrete().base_rate(y[velocity_of(face)]) / curve(face).mobility;
  return wave_speed_squared_ *
         (gradient - plastic_rate(y[stress_of(face)], face) / curve(face).mobility);
}

double YieldingLayer::wall_friction(std::span<const double> y, std::size_t cell) const {
  const auto phi = [&](std::size_t face) {
    return curve(face).volume_fraction(plastic_rate(y[stress_of(face)], face));
  };
  const double mean = 0.5 * (phi(cell) + phi(cell == 0 ? 0 : cell - 1));
  return discrete().layer().wall_deceleration(grid().centre[cell], mean);
}

double YieldingLayer::wall_deceleration(std::span<const double> y, std::size_t cell) const {
  const double u = y[velocity_of(cell)];
  return wall_friction(y, cell) * u / std::hypot(u, sticking_speed);
}

double YieldingLayer::wall_slope(std::span<const double> y, std::size_t cell) const {
  const double u = y[velocity_of(cell)];
  const double speed = std::hypot(u, sticking_speed);
  return wall_friction(y, cell) * (sticking_speed / speed) * (sticking_speed / speed) / speed;
}

void YieldingLayer::rate(double, std::span<const double> y, std::span<double> dydt) const {
  double above = 0.0;
  for (std::size_t k = 0; k < cells(); ++k) {
    const double rate = stress_rate(y, k);
    const double below = y[stress_of(k)] + elastic_time_ * rate;
    dydt[velocity_of(k)] = drive() - (below - above) / grid().width[k];
    if (discrete().layer().wall_drag > 0.0) dydt[velocity_of(k)] -= wall_deceleration(y, k);
    dydt[stress_of(k)] = rate;
    above = below;
  }
}

void YieldingLayer::jacobian(double, std::span<const double> y, BandView matrix) const {
  for (std::size_t k = 0; k < cells(); ++k) {
    const std::size_t u = velocity_of(k), sigma = stress_of(k);
    const double by_velocity = k + 1 < cells()
                                   ? wave_speed_squared_ / grid().distance[k]
                                   : wave_speed_squared_ / curve(k).mobility /
                                         discrete().base_velocity_slope(discrete().base_rate(y[u]));
    const double by_stress =
        -wave_speed_squared_ * yielding_[k].slope(y[sigma]) / curve(k).mobility;
    /// d(stress rate below cell k) / d(unknown), once as the rate itself and, through the damping,
    /// in the balances of the cells above (-) and below (+) the face.
    const auto add = [&](std::size_t unknown, double slope, double direct) {
      const double total = direct + elastic_time_ * slope;
      matrix(sigma, unknown) = slope;
      matrix(u, unknown) -= total / grid().width[k];
      if (k + 1 < cells()) matrix(velocity_of(k + 1), unknown) += total / grid().width[k + 1];
    };
    add(u, by_velocity, 0.0);
    if (k + 1 < cells()) add(velocity_of(k + 1), -by_velocity, 0.0);
    add(sigma, by_stress, 1.0);
    if (discrete().layer().wall_drag > 0.0) matrix(u, u) -= wall_slope(y, k);
  }
}

double YieldingLayer::event(double t, std::span<const double> y) const {
  std::array<double, 2> values{};
  events(t, y, values);
  return values[dense_event];
}

void YieldingLayer::events(double, std::span<const double> y, std::span<double> values) const {
  const double limit = dense_share * curve(cells() - 1).I_phi;
  double lost = -1.0;
  double excess = -INFINITY;
  for (std::size_t k = 0; k < cells(); ++k) {
    const double sigma = y[stress_of(k)];
    excess = std::max(excess, std::abs(sigma) - curve(k).yield_stress);
    if (std::isinf(limit)) continue;
    // a stress between two steps may exceed what any q carries, which it approaches as I does I_phi
    const double q = curve(k).scaled_rate(std::abs(sigma)).value_or(INFINITY);
    const double I = std::isinf(q) ? curve(k).I_phi : q / (1.0 + q / curve(k).I_phi);
    lost = std::max(lost, I / limit - 1.0);
  }
  values[dense_event] = lost;
  values[yield_event] = excess - 1e-9 * drive() * discrete().layer().mass;
}

std::string YieldingLayer::component_name(std::size_t i) const {
  const std::string place = face_name(i / 2);
  return i % 2 == 0 ? "the velocity above " + place : "the stress at " + place;
}

std::vector<double> YieldingLayer::state(const Motion& motion) const {
  std::vector<double> y(2 * cells());
  for (std::size_t k = 0; k < cells(); ++k) {
    y[velocity_of(k)] = motion.velocity[k];
    y[stress_of(k)] = motion.stress[k];
  }
  return y;
}

Motion YieldingLayer::motion(std::span<const double> state) const {
  Motion motion;
  for (std::size_t k = 0; k < cells(); ++k) {
    motion.velocity.push_back(state[velocity_of(k)]);
    motion.stress.push_back(state[stress_of(k)]);
    // a state that the solver failed at may have a stress beyond the law: no rate belongs to it
    const double stress = std::abs(motion.stress[k]);
    motion.rate.push_back(curve(k).scaled_rate(stress) ? plastic_rate(motion.stress[k], k) : 0.0);
  }
  return motion;
}

double YieldingLayer::mean_velocity(std::span<const double> y) const {
  double momentum = 0.0;
  for (std::size_t k = 0; k < cells(); ++k) momentum += y[velocity_of(k)] * grid().width[k];
  return momentum / discrete().layer().mass;
}

double YieldingLayer::acceleration(std::span<const double>,
                                   std::span<const double> rate,
                                   std::size_t cell) const {
  return rate[velocity_of(cell)];
}

}  // namespace grainlaw::continuum
