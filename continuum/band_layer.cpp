#include "continuum/band_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

namespace grainlaw::continuum {
namespace {

constexpr std::size_t stress_of(std::size_t face) {
  return 2 * face;
}
constexpr std::size_t velocity_of(std::size_t cell) {
  return 2 * cell + 1;
}

double pressure_at(const BandProblem& problem, double mass) {
  if (const auto* shear = std::get_if<PlaneShear>(&problem.flow))
    return shear->load + shear->gravity * mass;
  return std::get<BodyForceBox>(problem.flow).pressure;
}

}  // namespace

BandLayer::BandLayer(const BandProblem& problem,
                     std::vector<double> mass,
                     BandEnd first,
                     BandEnd last,
                     double driving_stress,
                     double elastic_time)
    : problem_(problem),
      first_(first),
      last_(last),
      cells_(mass.size() - 1),
      elastic_time_(elastic_time) {
  for (std::size_t i = 0; i <= cells_; ++i) {
    const double pressure = pressure_at(problem, mass[i]);
    const FlowCurve curve = problem.curve(pressure);
    const double before = i == 0 ? mass[0] : 0.5 * (mass[i - 1] + mass[i]);
    const double after = i == cells_ ? mass[i] : 0.5 * (mass[i] + mass[i + 1]);
    faces_.push_back({.mass = mass[i],
                      .distance = after - before,
                      .pressure = pressure,
                      .curve = curve,
                      .yielding = YieldingCurve(curve, driving_stress)});
  }
  // critical damping of the slowest wave, as for a layer on a base
  const double speed = 4.0 * mass.back() / (std::numbers::pi * elastic_time);
  wave_speed_squared_ = speed * speed;
}

bool BandLayer::held(std::size_t face) const {
  return (face == 0 && !first_.velocity) || (face == cells_ && !last_.velocity);
}

double BandLayer::plastic_rate(std::span<const double> y, std::size_t face) const {
  try {
    return faces_[face].yielding.rate(y[stress_of(face)]);
  } catch (const StateError& error) {
    throw StateError(fmt::format("{} {}", component_name(stress_of(face)), error.what()));
  }
}

double BandLayer::stress_rate(std::span<const double> y, std::size_t face) const {
  if (held(face)) return 0.0;
  const double before = face == 0 ? *first_.velocity : y[velocity_of(face - 1)];
  const double after = face == cells_ ? *last_.velocity : y[velocity_of(face)];
  const Face& at = faces_[face];
  return wave_speed_squared_ *
         ((before - after) / at.distance - plastic_rate(y, face) / at.curve.mobility);
}

double BandLayer::volume_fraction(std::span<const double> y, std::size_t cell) const {
  const auto phi = [&](std::size_t face) {
    const FlowCurve& curve = faces_[face].curve;
    const auto q = curve.scaled_rate(std::abs(y[stress_of(face)]));
    return curve.volume_fraction(q.value_or(0.0));
  };
  return 0.5 * (phi(cell) + phi(cell + 1));
}

std::vector<double> BandLayer::drive(std::span<const double> y) const {
  std::vector<double> force(cells_, 0.0);
  const auto* box = std::get_if<BodyForceBox>(&problem_.flow);
  if (box == nullptr) return force;
  double length = 0.0;  // of the quarter as dilated as it is
  for (std::size_t k = 0; k < cells_; ++k) {
    const double width = cell_mass(k) / volume_fraction(y, k);
    force[k] = length + 0.5 * width;
    length += width;
  }
  for (double& f : force) f = -box->amplitude * std::sin(0.5 * std::numbers::pi * f / length);
  return force;
}

void BandLayer::rate(double, std::span<const double> y, std::span<double> dydt) const {
  const std::vector<double> force = drive(y);
  for (std::size_t i = 0; i <= cells_; ++i) dydt[stress_of(i)] = stress_rate(y, i);
  const auto stress = [&](std::size_t face) {
    return y[stress_of(face)] + elastic_time_ * dydt[stress_of(face)];
  };
  for (std::size_t k = 0; k < cells_; ++k)
    dydt[velocity_of(k)] = force[k] + (stress(k) - stress(k + 1)) / cell_mass(k);
}

/// Without the change of the force in the box as it dilates, which Newton converges without.
void BandLayer::jacobian(double, std::span<const double> y, BandView matrix) const {
  for (std::size_t i = 0; i <= cells_; ++i) {
    const Face& at = faces_[i];
    const std::size_t sigma = stress_of(i);
    /// d(stress rate of the face) / d(unknown), as the rate itself and in the balances of the cells
    /// before (-) and behind (+) the face.
    const auto add = [&](std::size_t unknown, double slope, double direct) {
      const double total = direct + elastic_time_ * slope;
      matrix(sigma, unknown) = slope;
      if (i > 0) matrix(velocity_of(i - 1), unknown) -= total / cell_mass(i - 1);
      if (i < cells_) matrix(velocity_of(i), unknown) += total / cell_mass(i);
    };
    const double stiffness = held(i) ? 0.0 : wave_speed_squared_;
    if (i > 0) add(velocity_of(i - 1), stiffness / at.distance, 0.0);
    if (i < cells_) add(velocity_of(i), -stiffness / at.distance, 0.0);
    const double softening = at.yielding.slope(y[sigma]) / at.curve.mobility;
    add(sigma, -stiffness * softening, 1.0);
  }
}

std::string BandLayer::component_name(std::size_t i) const {
  return fmt::format("the {} {} {} of {} from the moving end",
                     i % 2 == 0 ? "stress" : "velocity",
                     i % 2 == 0 ? "at face" : "of cell",
                     i / 2 + 1,
                     cells_ + (i % 2 == 0 ? 1 : 0));
}

std::vector<double> BandLayer::rest() const {
  std::vector<double> y(2 * cells_ + 1, 0.0);
  if (held(0)) y.front() = first_.stress;
  if (held(cells_)) y.back() = last_.stress;
  return y;
}

double BandLayer::momentum(std::span<const double> y) const {
  double momentum = 0.0;
  for (std::size_t k = 0; k < cells_; ++k) momentum += y[velocity_of(k)] * cell_mass(k);
  return std::abs(momentum);
}

double BandLayer::largest_acceleration(std::span<const double> rate) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < cells_; ++k)
    largest = std::max(largest, std::abs(rate[velocity_of(k)]));
  return largest;
}

BandState BandLayer::band_state(std::span<const double> y) const {
  // a state that the solver failed at may have a stress beyond the law: no rate belongs to it
  const auto rate = [&](std::size_t face) {
    const Face& at = faces_[face];
    return at.curve.scaled_rate(std::abs(y[stress_of(face)])) ? plastic_rate(y, face) : 0.0;
  };
  // velocity at the faces; at an end without a wall that of a cell with the shear of its face
  const auto velocity = [&](std::size_t face) {
    if (face == 0 && first_.velocity) return *first_.velocity;
    if (face == cells_ && last_.velocity) return *last_.velocity;
    const double step = rate(face) / faces_[face].curve.mobility * faces_[face].distance;
    if (face == 0) return y[velocity_of(0)] + step;
    if (face == cells_) return y[velocity_of(cells_ - 1)] - step;
    const double share = 0.5 * cell_mass(face - 1) / faces_[face].distance;
    return (1.0 - share) * y[velocity_of(face - 1)] + share * y[velocity_of(face)];
  };
  BandState state;
  double along = 0.0;
  for (std::size_t k = 0; k < cells_; ++k) {
    BandCell cell;
    cell.mass = cell_mass(k);
    cell.volume_fraction = volume_fraction(y, k);
    cell.width = cell.mass / cell.volume_fraction;
    cell.along = along + 0.5 * cell.width;
    along += cell.width;
    cell.shear_stress = 0.5 * (y[stress_of(k)] + y[stress_of(k + 1)]);
    cell.pressure = 0.5 * (faces_[k].pressure + faces_[k + 1].pressure);
    cell.shear_rate = (velocity(k) - velocity(k + 1)) / cell.width;
    state.cells.push_back(cell);
  }
  state.wall = {.shear_stress = y.front(),
                .pressure = faces_.front().pressure,
                .shear_rate = faces_.front().curve.shear_rate(rate(0)),
                .volume_fraction = faces_.front().curve.volume_fraction(rate(0))};
  state.velocity = velocity(0) - velocity(cells_);
  return state;
}

}  // namespace grainlaw::continuum
