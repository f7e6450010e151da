#include "continuum/discrete_layer.h"

#include <algorithm>
#include <cmath>

#include "continuum/walled_layer.h"

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

DiscreteLayer::DiscreteLayer(const Layer& layer, MassGrid grid)
    : layer_(layer), grid_(std::move(grid)) {
  for (const double mass_above : grid_.face) curves_.push_back(layer_.curve(mass_above));
}

std::vector<double> DiscreteLayer::velocity(std::span<const double> q) const {
  std::vector<double> u(cells());
  double sum = 0.0;
  for (std::size_t k = cells(); k-- > 0;)
    u[k] = sum +=
        k + 1 == cells() ? base_velocity(q[k]) : q[k] / curves_[k].mobility * grid_.distance[k];
  return u;
}

double DiscreteLayer::base_velocity(double q) const {
  const FlowCurve& base = curves_.back();
  return q / base.mobility * grid_.distance.back() + layer_.slip_length * base.shear_rate(q);
}

double DiscreteLayer::base_velocity_slope(double q) const {
  const FlowCurve& base = curves_.back();
  const double dilated = 1.0 + std::abs(q) / base.I_phi;
  return (grid_.distance.back() +
          layer_.slip_length * base.static_volume_fraction / (dilated * dilated)) /
         base.mobility;
}

double DiscreteLayer::base_rate(double velocity) const {
  // q A + B q / (1 + q / I_phi) = u, a quadratic equation for |q|
  const FlowCurve& base = curves_.back();
  const double A = grid_.distance.back() / base.mobility;
  const double B = layer_.slip_length * base.static_volume_fraction / base.mobility;
  const double u = std::abs(velocity);
  return std::copysign(bagnold_shear_rate(A / base.I_phi, A + B - u / base.I_phi, u), velocity);
}

Motion DiscreteLayer::steady() const {
  Motion motion;
  WalledFlow walled;
  if (layer_.wall_drag > 0.0) walled = walled_flow(layer_, grid_.face);
  for (std::size_t k = 0; k < cells(); ++k) {
    motion.stress.push_back(layer_.wall_drag > 0.0 ? walled.points[k].stress
                                                   : layer_.driving_stress(grid_.face[k]));
    const bool rests = layer_.wall_drag > 0.0 && grid_.face[k] > walled.sheared_mass;
    if (rests) motion.stress[k] = std::min(motion.stress[k], curves_[k].yield_stress);
    motion.rate.push_back(curves_[k].scaled_rate(motion.stress[k]).value());
  }
  motion.velocity = velocity(motion.rate);
  return motion;
}

Motion DiscreteLayer::rest() const {
  struct Corner {
    double mass = 0.0, stress = 0.0;
  };
  const auto slope = [](const Corner& a, const Corner& b) {
    return (b.stress - a.stress) / (b.mass - a.mass);
  };
  std::vector<Corner> hull{{}};  // lower convex hull of the yield stress, from the free surface
  for (std::size_t k = 0; k < cells(); ++k) {
    const Corner next{grid_.face[k], curves_[k].yield_stress};
    while (hull.size() > 1 && slope(hull.end()[-2], hull.back()) >= slope(hull.back(), next))
      hull.pop_back();
    hull.push_back(next);
  }
  Motion motion{.velocity = std::vector<double>(cells(), 0.0),
                .rate = std::vector<double>(cells(), 0.0),
                .stress = {}};
  std::size_t corner = 1;
  Corner above;
  for (const double mass : grid_.face) {
    if (mass > hull[corner].mass) ++corner;
    const double rise = std::min(slope(hull[corner - 1], hull[corner]), layer_.sine);
    above = {mass, above.stress + rise * (mass - above.mass)};
    motion.stress.push_back(above.stress);
  }
  return motion;
}

double DiscreteLayer::mean_velocity(const Motion& motion) const {
  double momentum = 0.0;
  for (std::size_t k = 0; k < cells(); ++k) momentum += motion.velocity[k] * grid_.width[k];
  return momentum / layer_.mass;
}

double DiscreteLayer::largest_inertial_number(std::span<const double> q) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < cells(); ++k)
    largest =
        std::max(largest, curves_[k].shear_rate(q[k]) / std::sqrt(layer_.pressure(grid_.face[k])));
  return largest;
}

double DiscreteLayer::relaxation_time(std::span<const double> q) const {
  double time = 0.0;
  for (std::size_t k = 0; k < cells(); ++k)
    if (q[k] > 0.0)  // the plug follows at once
      time += grid_.face[k] * grid_.distance[k] /
              (curves_[k].mobility * curves_[k].viscous_slope(q[k]));
  return time;
}

Profile DiscreteLayer::profile(const Motion& motion) const {
  const std::size_t n = cells();
  const auto& q = motion.rate;
  Profile profile;
  profile.rows.resize(n + 2);
  double z = layer_.base_height;
  const auto row = [&](double mass_above, double velocity, std::size_t upper, std::size_t lower) {
    const auto mean = [&](auto value) { return 0.5 * (value(upper) + value(lower)); };
    const auto shear_rate = [&](std::size_t k) { return curves_[k].shear_rate(q[k]); };
    return ProfileRow{
        .z = z,
        .mass_above = mass_above,
        .velocity = velocity,
        .shear_rate = mean(shear_rate),
        .shear_stress = mean([&](std::size_t k) { return motion.stress[k]; }),
        .pressure = layer_.pressure(mass_above),
        .volume_fraction = mean([&](std::size_t k) { return curves_[k].volume_fraction(q[k]); }),
        .inertial_number = mean([&](std::size_t k) {
          return shear_rate(k) / std::sqrt(layer_.pressure(grid_.face[k]));
        })};
  };
  const auto climb = [&](std::size_t face, double mass) {
    z += mass / curves_[face].volume_fraction(q[face]);
  };
  profile.rows[0] =
      row(layer_.mass, layer_.slip_length * curves_[n - 1].shear_rate(q[n - 1]), n - 1, n - 1);
  for (std::size_t k = n; k-- > 0;) {
    climb(k, grid_.distance[k]);
    profile.rows[n - k] = row(grid_.centre[k], motion.velocity[k], k == 0 ? 0 : k - 1, k);
    profile.flux += motion.velocity[k] * grid_.width[k];
  }
  // The topmost face stands for the half cell above it; at M = 0 there is neither stress nor rate.
  profile.rows[n].shear_stress = 0.5 * motion.stress[0];
  profile.rows[n].shear_rate = 0.5 * curves_[0].shear_rate(q[0]);
  climb(0, grid_.centre[0]);
  profile.height = z;
  profile.surface_velocity = motion.velocity[0] + q[0] / curves_[0].mobility * grid_.centre[0];
  profile.rows[n + 1] = row(0.0, profile.surface_velocity, 0, 0);
  profile.rows[n + 1].shear_stress = 0.0;
  profile.rows[n + 1].shear_rate = 0.0;
  profile.plug_mass = plug_edge(motion.stress).mass;
  return profile;
}

DiscreteLayer::PlugEdge DiscreteLayer::plug_edge(std::span<const double> stress) const {
  const auto excess = [&](std::size_t k) { return std::abs(stress[k]) - curves_[k].yield_stress; };
  std::size_t k = 0;  // the highest face that yields
  while (k < cells() && excess(k) <= 0.0) ++k;
  if (k == 0) return {};
  if (k == cells()) return {layer_.mass, 0.0};
  const double above = excess(k - 1);
  const double below = excess(k);
  const double width = grid_.width[k];  // of the cell between them
  return {grid_.face[k - 1] + width * above / (above - below), 0.5 * width};
}

}  // namespace grainlaw::continuum
