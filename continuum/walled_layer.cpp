#include "continuum/walled_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace grainlaw::continuum {
namespace {

constexpr int steps_over_the_layer = 1000;
/// Ten times the error of the march: what flows with it flows on every other grid of masses too.
constexpr double verdict_margin = 1e-8;

LocalFlow flow_at(const Layer& layer, double mass, double stress) {
  return std::visit(
      [&](const auto& law) { return local_flow(law, layer.grains, stress, layer.pressure(mass)); },
      layer.law);
}

/// From the surface: int p / phi dM, shear, height, flux. The first, not the stress itself: at the
/// surface the friction is a ratio of two vanishing numbers, of which one stays exact this way.
using Sums = std::array<double, 4>;

class March {
 public:
  March(const Layer& layer, double margin)
      : layer_(layer), step_(std::sqrt(layer.mass) / steps_over_the_layer), margin_(margin) {}

  WalledFlow to(std::span<const double> masses);

 private:
  enum class Part { plug, sheared, resting };

  Sums slope(double s, const Sums& sums) const;
  struct State {
    double s = 0.0;
    Sums sums{};
  };
  State stepped(double length) const;
  double stress(double mass, const Sums& sums) const {
    return layer_.driving_stress(mass) - layer_.wall_drag * sums[0];
  }
  double mass(const State& at) const { return std::max(at.s * at.s, layer_.surface_mass()); }
  bool yields(const State& at) const {
    return stress(mass(at), at.sums) > layer_.curve(mass(at)).yield_stress;
  }
  bool advance(double to);
  void change_part();

  const Layer& layer_;
  double step_;
  double margin_;
  Part part_ = Part::plug;
  State here_;
  WalledFlow flow_;
};

/// d/ds of the sums, M = s^2, in the part that was entered: past its end the sums go on smoothly.
Sums March::slope(double s, const Sums& sums) const {
  const double mass = std::max(s * s, layer_.surface_mass());
  const FlowCurve curve = layer_.curve(mass);
  const double q =
      part_ == Part::sheared ? curve.scaled_rate(stress(mass, sums)).value_or(0.0) : 0.0;
  const double phi = curve.volume_fraction(q);
  const double dM = 2.0 * s;
  return {dM * layer_.pressure(mass) / phi,
          dM * q / curve.mobility,
          dM / phi,
          dM * mass * q / curve.mobility};
}

March::State March::stepped(double length) const {
  const double s = here_.s;
  const Sums& y = here_.sums;
  const auto moved = [&](const Sums& by, double share) {
    Sums result = y;
    for (std::size_t i = 0; i < y.size(); ++i) result[i] += share * length * by[i];
    return result;
  };
  const Sums k1 = slope(s, y);
  const Sums k2 = slope(s + 0.5 * length, moved(k1, 0.5));
  const Sums k3 = slope(s + 0.5 * length, moved(k2, 0.5));
  const Sums k4 = slope(s + length, moved(k3, 1.0));
  Sums end = y;
  for (std::size_t i = 0; i < y.size(); ++i)
    end[i] += length / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  return {s + length, end};
}

void March::change_part() {
  if (part_ == Part::plug) {
    part_ = Part::sheared;
    flow_.plug_mass = mass(here_);
  } else {
    part_ = Part::resting;
    flow_.sheared_mass = mass(here_);
  }
}

/// False where the law has no steady flow any more.
bool March::advance(double to) {
  const double end = std::sqrt(to);
  while (here_.s < end) {
    double length = std::min(step_, end - here_.s);
    State next = stepped(length);
    const bool changes = part_ != Part::resting && yields(next) != (part_ == Part::sheared);
    if (changes) {  // bisection of the step onto the end of this part
      double low = 0.0;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + length);
        (yields(stepped(middle)) == (part_ == Part::sheared) ? low : length) = middle;
      }
      next = stepped(length);
    }
    if (end - next.s < 1e-14 * end) next.s = end;
    here_ = next;
    if (changes) change_part();
    if (part_ != Part::sheared) continue;
    const double at = mass(here_);
    const LocalState state = flow_at(layer_, at, (1.0 + margin_) * stress(at, here_.sums)).state;
    if (state == LocalState::flows || state == LocalState::rests) continue;
    flow_.worst = state;
    flow_.worst_mass = at;
    return false;
  }
  return true;
}

WalledFlow March::to(std::span<const double> masses) {
  flow_.plug_mass = flow_.sheared_mass = layer_.mass;
  if (yields(here_)) {
    part_ = Part::sheared;
    flow_.plug_mass = 0.0;
  }
  for (const double mass : masses) {
    if (!advance(mass)) return flow_;
    const auto& [walls, shear, height, flux] = here_.sums;
    flow_.points.push_back({mass, stress(mass, here_.sums), shear, height, flux});
  }
  if (flow_.plug_mass < layer_.mass) flow_.worst = LocalState::flows;
  return flow_;
}

/// Mass of every row from the surface down; the profile runs the other way.
std::vector<double> row_masses(const Layer& layer, int rows) {
  std::vector<double> masses;
  for (int i = 0; i < rows; ++i) masses.push_back(layer.mass * i / (rows - 1));
  return masses;
}

std::string words(LocalState state) {
  return state == LocalState::no_steady        ? "the drive exceeds the largest friction of the law"
         : state == LocalState::no_dense_state ? "it would take I beyond I_phi, where phi vanishes"
                                               : "softness takes all friction";
}

Outcome outcome(const WalledFlow& flow) {
  switch (flow.worst) {
    case LocalState::rests:
      return Outcome::arrested;
    case LocalState::no_dense_state:
      return Outcome::no_dense_state;
    case LocalState::flows:
      return flow.plug_mass > 0.0 ? Outcome::plug : Outcome::steady;
    default:
      return Outcome::no_steady;
  }
}

}  // namespace

WalledFlow walled_flow(const Layer& layer, std::span<const double> masses, double margin) {
  return March(layer, margin).to(masses);
}

Profile walled_profile(const Layer& layer, int rows) {
  const WalledFlow flow = walled_flow(layer, row_masses(layer, rows));
  const WalledPoint& base = flow.points.back();
  const double slip = layer.slip_length * flow_at(layer, base.mass, base.stress).shear_rate;
  Profile profile;
  for (std::size_t i = flow.points.size(); i-- > 0;) {
    const WalledPoint& point = flow.points[i];
    const double at = std::max(point.mass, layer.surface_mass());
    const bool sheared = at > flow.plug_mass && at <= flow.sheared_mass;
    const LocalFlow local = flow_at(layer, at, sheared ? point.stress : 0.0);
    profile.rows.push_back({.z = layer.base_height + base.height - point.height,
                            .mass_above = point.mass,
                            .velocity = slip + base.shear - point.shear,
                            .shear_rate = i > 0 ? local.shear_rate : 0.0,
                            .shear_stress = i > 0 ? point.stress : 0.0,
                            .pressure = layer.pressure(point.mass),
                            .volume_fraction = local.volume_fraction,
                            .inertial_number = local.inertial_number});
  }
  profile.height = profile.rows.back().z;
  profile.surface_velocity = slip + base.shear;
  profile.flux = base.flux + slip * layer.mass;
  profile.plug_mass = flow.plug_mass;
  return profile;
}

Verdict walled_verdict(const Layer& layer) {
  if (no_friction_left(layer))
    return {.outcome = Outcome::no_steady,
            .text = "softness takes all friction at the base, where the law has no answer"};
  const std::array<double, 1> base{layer.mass};
  const WalledFlow flow = walled_flow(layer, base, verdict_margin);
  Verdict verdict{.outcome = outcome(flow), .plug_mass = flow.plug_mass};
  verdict.text = fmt::format("at {:.5g} deg between side walls tan(theta) = {:.5g}",
                             layer.direction * layer.inclination * 180.0 / std::numbers::pi,
                             layer.sine / layer.cosine);
  if (verdict.outcome == Outcome::arrested) {
    verdict.text += "; base and walls hold the layer at rest";
  } else if (!flows(verdict.outcome)) {
    verdict.text += fmt::format(
        "; under {:.3g} % of the mass {}", 100.0 * flow.worst_mass / layer.mass, words(flow.worst));
  } else {
    const double at = flow.sheared_mass;
    verdict.text += fmt::format("; the upper {:.4g} % of the mass flow", 100.0 * at / layer.mass);
    if (at < layer.mass) verdict.text += ", the rest is held by the walls";
    if (flow.plug_mass > 0.0)
      verdict.text += fmt::format("; {:.3g} % move as a plug", 100.0 * flow.plug_mass / layer.mass);
  }
  return verdict;
}

}  // namespace grainlaw::continuum
