#include <fmt/format.h>

#include <cmath>

#include "dem/scene_checks.h"

namespace grainlaw::dem {
namespace {

constexpr std::string_view normal = "contact.normal";
constexpr std::string_view cohesion = "contact.cohesion";
constexpr std::string_view friction = "contact.friction";

/// What the checks of laws need to know of the scene around them.
struct Surroundings {
  const Grains& grains;
  double max_overlap;
  double heaviest;              ///< largest reduced mass of a contact [mass]
  double lightest;              ///< smallest one [mass]
  double prefactor = 1.0;       ///< f(x) at the deepest overlap
  double tangent_factor = 1.0;  ///< tangent stiffness there over f(x) k_n
  double stiffness = 0.0;       ///< k_n [mass/time^2]
};

/// A grain at a wall or on a glued one has its own mass as reduced mass; without walls the
/// heaviest contact is that of the two largest grains.
double heaviest_reduced_mass(const Scene& scene) {
  const double mass = scene.grains.mass_of(scene.grains.largest());
  const bool periodic = std::holds_alternative<SimpleShear>(scene.geometry) ||
                        std::holds_alternative<BodyForceBox>(scene.geometry);
  return periodic ? 0.5 * mass : mass;
}

Surroundings surroundings(const Scene& scene) {
  Surroundings out{.grains = scene.grains,
                   .max_overlap = scene.max_overlap,
                   .heaviest = heaviest_reduced_mass(scene),
                   .lightest = 0.5 * scene.grains.mass_of(scene.grains.smallest())};
  out.stiffness = std::visit([](const auto& law) { return law.stiffness; }, scene.normal);
  if (std::holds_alternative<Hertz>(scene.normal)) {
    out.prefactor = std::sqrt(0.5 * scene.max_overlap);
    out.tangent_factor = 1.5;
  }
  return out;
}

/// Spring f K u and dashpot f c v on the mass m, f the prefactor: critical where f c^2 = 4 K m.
/// A rate or a root is worst for the heaviest pair, the same dashpot for all for the lightest.
void check_damping(double viscosity_of_heaviest,
                   double viscosity_of_lightest,
                   double stiffness,
                   const Surroundings& around,
                   const Place& at) {
  const auto share = [&](double viscosity, double mass) {
    return viscosity * std::sqrt(around.prefactor / (4.0 * stiffness * mass));
  };
  const double worst = std::max(share(viscosity_of_heaviest, around.heaviest),
                                share(viscosity_of_lightest, around.lightest));
  if (std::min(viscosity_of_heaviest, viscosity_of_lightest) >= 0.0 && worst < 1.0) return;
  refuse(at,
         fmt::format("{} damping is {:.4g} of the critical one, at which a contact no longer "
                     "springs back: must lie in [0, 1); lower the damping or raise the stiffness",
                     at.section == normal ? "normal" : "tangential",
                     worst));
}

template <class Law>
void check_normal(const Law& law, const Surroundings& around) {
  require_positive(law.stiffness, {normal, "stiffness"}, "normal stiffness");
  check_damping(viscosity(law, around.heaviest),
                viscosity(law, around.lightest),
                around.tangent_factor * law.stiffness,
                around,
                {normal, ""});
}

void check_coefficient(double coefficient) {
  constexpr Place at{friction, "coefficient"};
  require_not_negative(coefficient, at, "friction coefficient");
  if (coefficient > 0.0) return;
  refuse(at,
         fmt::format("friction coefficient = {}: leave the friction law out instead, then grains "
                     "need no rotation and contacts no history",
                     coefficient));
}

template <class Law>
void check_tangential(const Law& law, const Surroundings& around) {
  check_coefficient(law.coefficient);
  require_positive(law.stiffness, {friction, "stiffness"}, "tangential stiffness");
  // At the contact point two free solid spheres weigh 2/7 of their reduced mass.
  check_damping(law.damping * around.heaviest + law.dashpot,
                law.damping * around.lightest + law.dashpot,
                2.0 / 7.0 * law.stiffness,
                around,
                {friction, "damping_rate"});
}

void check_friction(const Frictionless&, const Surroundings&) {}
void check_friction(const Sliding& law, const Surroundings& around) {
  check_tangential(law, around);
}
void check_friction(const StickSlip& law, const Surroundings& around) {
  check_tangential(law, around);
  if (law.static_coefficient > law.coefficient && std::isfinite(law.static_coefficient)) return;
  refuse({friction, "static_coefficient"},
         fmt::format("static_coefficient = {}: must be finite and above coefficient = {}; for "
                     "equal ones take law = \"sliding\"",
                     law.static_coefficient,
                     law.coefficient));
}

void check_strength(double value, std::string_view key) {
  require_not_negative(value, {cohesion, key}, key);
  if (value > 0.0) return;
  refuse({cohesion, key},
         fmt::format("{} = {}: leave [contact.cohesion] out instead, then pairs act in contact "
                     "only",
                     key,
                     value));
}

/// A longer reach makes every grain act on its second neighbours.
void check_range(double range, std::string_view key, const Grains& grains) {
  const double most = limits::attraction_range * grains.smallest();
  if (range <= most) return;
  refuse({cohesion, key},
         fmt::format("the attraction reaches {:.4g} beyond contact: at most {:.4g}, {} of the "
                     "smallest diameter; change {}",
                     range,
                     most,
                     limits::attraction_range,
                     key));
}

/// Overlap of two of the smallest grains that this constant attraction holds together; Hertz:
/// k overlap sqrt(overlap/d) = force.
double overlap_at_rest(double force, const Surroundings& around) {
  if (around.tangent_factor == 1.0) return force / around.stiffness;
  return std::cbrt(std::pow(force / around.stiffness, 2) * around.grains.smallest());
}

void check_rest(double attraction, std::string_view key, const Surroundings& around) {
  const double overlap = overlap_at_rest(attraction, around);
  const double most = around.max_overlap * 0.5 * around.grains.smallest();
  if (overlap < most) return;
  refuse({cohesion, key},
         fmt::format("the attraction {:.4g} pulls two grains at rest {:.4g} into each other: must "
                     "be below {:.4g}, max_overlap = {} of the smallest radius; lower {} or raise "
                     "the normal stiffness",
                     attraction,
                     overlap,
                     most,
                     around.max_overlap,
                     key));
}

void check_cohesion(const Cohesionless&, const Surroundings&) {}
void check_cohesion(const GaussianWell& law, const Surroundings& around) {
  check_strength(law.strength, "strength");
  require_positive(law.width, {cohesion, "width"}, "width of the well");
  check_range(law.range(), "width", around.grains);
}
void check_cohesion(const ReversibleAdhesion& law, const Surroundings& around) {
  check_strength(law.largest_force, "largest_force");
  require_positive(law.slope, {cohesion, "slope"}, "slope of the attraction");
  check_range(law.range(), "slope", around.grains);
  check_rest(law.largest_force, "largest_force", around);
}
void check_cohesion(const LiquidBridge& law, const Surroundings& around) {
  check_strength(law.surface_tension, "surface_tension");
  const double angle = law.contact_angle * 180.0 / std::numbers::pi;
  if (!(angle >= 0.0 && angle < limits::contact_angle)) {
    refuse({cohesion, "contact_angle"},
           fmt::format("contact_angle = {:.6g} degrees: must lie in [0, {}); beyond, a bridge "
                       "does not attract",
                       angle,
                       limits::contact_angle));
  }
  require_positive(law.volume, {cohesion, "volume"}, "volume of a bridge");
  check_range(law.range(), "volume", around.grains);
  // The smallest grain is pulled most by the largest one: r = 2 R_i R_j / (R_i + R_j).
  const double radius = around.grains.smallest() * around.grains.largest() /
                        (around.grains.smallest() + around.grains.largest());
  check_rest(law.largest_attraction(radius), "surface_tension", around);
}

}  // namespace

void check_laws(const Scene& scene) {
  const Surroundings around = surroundings(scene);
  std::visit([&](const auto& law) { check_normal(law, around); }, scene.normal);
  std::visit([&](const auto& law) { check_friction(law, around); }, scene.friction);
  std::visit([&](const auto& law) { check_cohesion(law, around); }, scene.cohesion);
}

}  // namespace grainlaw::dem
