#include "continuum/shear_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::continuum {

MassGrid::MassGrid(double mass, int cells, double grading) {
  const auto at = [&](double k) { return mass * std::pow(k / cells, grading); };
  for (int k = 0; k < cells; ++k) {
    face.push_back(at(k + 1.0));
    centre.push_back(at(k + 0.5));
    width.push_back(at(k + 1.0) - at(k));
    distance.push_back((k + 1 < cells ? at(k + 1.5) : mass) - centre.back());
  }
}

ShearLayer::ShearLayer(const Layer& layer, MassGrid grid, double delta)
    : layer_(layer), grid_(std::move(grid)), delta_(delta) {
  for (std::size_t k = 0; k < grid_.cells(); ++k) curves_.push_back(layer_.curve(grid_.face[k]));
}

double ShearLayer::stress(std::size_t face, double q) const {
  const FlowCurve& curve = curves_[face];
  const double yielded = delta_ == 0.0 ? 1.0 : q / std::sqrt(q * q + delta_ * delta_);
  return curve.yield_stress * yielded + curve.viscous_stress(q);
}

double ShearLayer::slope(std::size_t face, double q) const {
  const FlowCurve& curve = curves_[face];
  const double size = std::sqrt(q * q + delta_ * delta_);
  const double yielding = delta_ == 0.0 ? 0.0 : (delta_ / size) * (delta_ / size) / size;
  return curve.yield_stress * yielding + curve.viscous_slope(q);
}

double ShearLayer::acceleration(std::span<const double> q, std::size_t cell) const {
  const double above = cell == 0 ? 0.0 : stress(cell - 1, q[cell - 1]);
  return layer_.sine - (stress(cell, q[cell]) - above) / grid_.width[cell];
}

void ShearLayer::rate(double, std::span<const double> q, std::span<double> dqdt) const {
  double stress_above = 0.0;
  double acceleration_above = 0.0;
  for (std::size_t k = 0; k < size(); ++k) {
    const double stress_below = stress(k, q[k]);
    const double here = layer_.sine - (stress_below - stress_above) / grid_.width[k];
    if (k > 0)
      dqdt[k - 1] = curves_[k - 1].mobility * (acceleration_above - here) / grid_.distance[k - 1];
    stress_above = stress_below;
    acceleration_above = here;
  }
  dqdt.back() = curves_.back().mobility * acceleration_above / grid_.distance.back();
}

void ShearLayer::jacobian(double, std::span<const double> q, TridiagonalView matrix) const {
  for (std::size_t k = 0; k < size(); ++k) {
    const double stiffness = slope(k, q[k]);  // d tau_k / d q_k: drags the cell above, drives below
    const double above = stiffness / grid_.width[k];
    const double below = k + 1 < size() ? stiffness / grid_.width[k + 1] : 0.0;
    const auto factor = [&](std::size_t i) { return curves_[i].mobility / grid_.distance[i]; };
    if (k > 0) matrix(k - 1, k) = factor(k - 1) * above;
    matrix(k, k) = -factor(k) * (above + below);
    if (k + 1 < size()) matrix(k + 1, k) = factor(k + 1) * below;
  }
}

double ShearLayer::event(double, std::span<const double> q) const {
  if (std::isinf(curves_.back().I_phi)) return -1.0;
  return largest_inertial_number(q) / curves_.back().I_phi - (1.0 - 1e-3);
}

std::string ShearLayer::component_name(std::size_t i) const {
  return fmt::format("the scaled shear rate below cell {} of {}, mass above {:.4g} rho_p d",
                     i + 1,
                     size(),
                     grid_.face[i]);
}

double ShearLayer::largest_acceleration(std::span<const double> q) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < size(); ++k)
    largest = std::max(largest, std::abs(acceleration(q, k)));
  return largest;
}

double ShearLayer::largest_inertial_number(std::span<const double> q) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < size(); ++k)
    largest =
        std::max(largest, curves_[k].shear_rate(q[k]) / std::sqrt(layer_.pressure(grid_.face[k])));
  return largest;
}

double ShearLayer::mean_velocity(std::span<const double> q) const {
  double momentum = 0.0;  // int u dM = int M |du/dM| dM by parts
  for (std::size_t k = 0; k < size(); ++k)
    momentum += q[k] / curves_[k].mobility * grid_.distance[k] * grid_.face[k];
  return momentum / layer_.mass;
}

std::vector<double> ShearLayer::steady_state() const {
  std::vector<double> q;
  for (std::size_t k = 0; k < size(); ++k)
    q.push_back(curves_[k].scaled_rate(layer_.driving_stress(grid_.face[k])).value());
  return q;
}

double ShearLayer::relaxation_time(std::span<const double> q) const {
  double time = 0.0;
  for (std::size_t k = 0; k < size(); ++k)
    if (q[k] > 0.0)  // the plug follows at once
      time += grid_.face[k] * grid_.distance[k] /
              (curves_[k].mobility * curves_[k].viscous_slope(q[k]));
  return time;
}

Profile ShearLayer::rows(std::span<const double> q, const std::vector<double>& stress) const {
  const std::size_t n = size();
  Profile profile;
  profile.rows.resize(n + 2);
  double velocity = 0.0;
  double z = layer_.base_height;
  // From the base up: every sum has terms of one sign, no difference of large numbers.
  const auto climb = [&](std::size_t face, double mass) {
    velocity += q[face] / curves_[face].mobility * mass;
    z += mass / curves_[face].volume_fraction(q[face]);
  };
  const auto row = [&](double mass_above, std::size_t upper, std::size_t lower) {
    const auto mean = [&](auto value) { return 0.5 * (value(upper) + value(lower)); };
    const auto shear_rate = [&](std::size_t k) { return curves_[k].shear_rate(q[k]); };
    return ProfileRow{
        .z = z,
        .mass_above = mass_above,
        .velocity = velocity,
        .shear_rate = mean(shear_rate),
        .shear_stress = mean([&](std::size_t k) { return stress[k]; }),
        .pressure = layer_.pressure(mass_above),
        .volume_fraction = mean([&](std::size_t k) { return curves_[k].volume_fraction(q[k]); }),
        .inertial_number = mean([&](std::size_t k) {
          return shear_rate(k) / std::sqrt(layer_.pressure(grid_.face[k]));
        })};
  };
  profile.rows[0] = row(layer_.mass, n - 1, n - 1);
  for (std::size_t k = n; k-- > 0;) {
    climb(k, grid_.distance[k]);
    profile.rows[n - k] = row(grid_.centre[k], k == 0 ? 0 : k - 1, k);
    profile.flux += velocity * grid_.width[k];
  }
  // The topmost face stands for the half cell above it; at M = 0 there is neither stress nor rate.
  profile.rows[n].shear_stress = 0.5 * stress[0];
  profile.rows[n].shear_rate = 0.5 * curves_[0].shear_rate(q[0]);
  climb(0, grid_.centre[0]);
  profile.rows[n + 1] = row(0.0, 0, 0);
  profile.rows[n + 1].shear_stress = 0.0;
  profile.rows[n + 1].shear_rate = 0.0;
  profile.height = z;
  profile.surface_velocity = velocity;
  return profile;
}

Profile ShearLayer::profile(std::span<const double> q, double plug_mass) const {
  std::vector<double> tau(size());
  for (std::size_t k = 0; k < size(); ++k) tau[k] = stress(k, q[k]);
  Profile result = rows(q, tau);
  result.plug_mass = plug_mass;
  return result;
}

Profile ShearLayer::at_rest() const {
  std::vector<double> tau(size());
  for (std::size_t k = 0; k < size(); ++k) tau[k] = layer_.driving_stress(grid_.face[k]);
  Profile result = rows(std::vector<double>(size(), 0.0), tau);
  result.plug_mass = layer_.mass;
  return result;
}

ShearLayer::PlugEdge ShearLayer::plug_edge(std::span<const double> q) const {
  const auto excess = [&](std::size_t k) { return stress(k, q[k]) - curves_[k].yield_stress; };
  std::size_t k = size();  // lowest face that does not yield, counted from 1
  while (k > 0 && excess(k - 1) > 0.0) --k;
  if (k == 0) return {};
  if (k == size()) return {layer_.mass, 0.0};
  const double above = excess(k - 1);
  const double below = excess(k);
  const double width = grid_.width[k];  // of the cell between them
  return {grid_.face[k - 1] + width * above / (above - below), 0.5 * width};
}

bool needs_regularisation(const Layer& layer) {
  const auto* law = std::get_if<MuPhi>(&layer.law);
  if (!law) return std::get<GeneralisedBagnold>(layer.law).tau_c > 0.0;
  return (law->softness_friction && layer.grains.stiffness) ||
         (law->cohesion_friction && layer.grains.adhesion);
}

}  // namespace grainlaw::continuum
