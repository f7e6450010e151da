#include "continuum/layer.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "continuum/walled_layer.h"

namespace grainlaw::continuum {
namespace {

void require_positive(const char* name, double value) {
  if (!(std::isfinite(value) && value > 0.0))
    throw std::invalid_argument(fmt::format("{} = {} must be finite and positive", name, value));
}

void check(const ChuteCase& chute) {
  require_positive("gravity", chute.gravity);
  require_positive("mass_per_area", chute.mass_per_area);
  require_positive("grain diameter", chute.grains.diameter);
  require_positive("grain density", chute.grains.density);
  if (chute.grains.stiffness) require_positive("grain stiffness", *chute.grains.stiffness);
  const double adhesion = chute.grains.adhesion.value_or(0.0);
  if (!(std::isfinite(adhesion) && adhesion >= 0.0))
    throw std::invalid_argument(fmt::format("adhesion = {} must not be negative", adhesion));
  if (!(std::isfinite(chute.slip_length) && chute.slip_length >= 0.0))
    throw std::invalid_argument(
        fmt::format("slip_length = {} must not be negative", chute.slip_length));
  if (chute.walls) {
    require_positive("width between side walls", chute.walls->width);
    require_positive("friction of side walls", chute.walls->friction);
    require_positive("pressure_ratio of side walls", chute.walls->pressure_ratio);
  }
  // cos(pi/2) is 6e-17 in double: what remains of the pressure there is rounding
  if (!(std::abs(chute.inclination) < 0.5 * std::numbers::pi - 1e-12))
    throw std::invalid_argument(fmt::format(
        "inclination = {} rad leaves no pressure on the base; it must lie between -pi/2 and pi/2",
        chute.inclination));
}

std::variant<GeneralisedBagnold, MuPhi> dimensionless(std::variant<GeneralisedBagnold, MuPhi> law,
                                                      const Units& units) {
  if (auto* bagnold = std::get_if<GeneralisedBagnold>(&law)) {
    bagnold->a /= units.stress() * units.time * units.time;
    bagnold->b /= units.stress() * units.time;
    bagnold->tau_c /= units.stress();
  }
  return law;
}

GrainProperties dimensionless(const GrainProperties& grains, const Units& units) {
  GrainProperties result;
  if (grains.stiffness) result.stiffness = *grains.stiffness / units.stress() / units.length;
  if (grains.adhesion)
    result.adhesion = *grains.adhesion / units.stress() / (units.length * units.length);
  return result;
}

/// Mass above the plug edge, where the driving stress meets the yield stress. Bisection down to
/// neighbouring numbers: the excess has one sign change (see Verdict) and is cheap.
double plug_edge(const Layer& layer) {
  const auto flows = [&](double mass_above) {
    return layer.driving_stress(mass_above) > layer.curve(mass_above).yield_stress;
  };
  double rigid = layer.surface_mass();
  double sheared = layer.mass;
  if (flows(rigid)) return 0.0;
  for (;;) {
    const double middle = 0.5 * (rigid + sheared);
    if (middle <= rigid || middle >= sheared) return sheared;
    (flows(middle) ? sheared : rigid) = middle;
  }
}

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

std::string drive_text(const Layer& layer) {
  return fmt::format("at {:.5g} deg the driving friction at the base is tan(theta) = {:.5g}",
                     layer.direction * degrees(layer.inclination),
                     layer.sine / layer.cosine);
}

/// By how much tau / p elsewhere in the layer may exceed that at the base by rounding alone: tau, p
/// and the coefficients of the curve are a few products each, half an epsilon apiece. A flow this
/// close to the limit of the law exists at some heights and not at others.
constexpr double stress_rounding = 16.0 * std::numeric_limits<double>::epsilon();

Verdict flowing(const Layer& layer, const FlowCurve& base) {
  const double pressure = layer.pressure(layer.mass);
  const double tau = layer.driving_stress(layer.mass);
  const double shear_rate = base.shear_rate(*base.scaled_rate(tau));
  Verdict verdict{.outcome = Outcome::steady,
                  .text = fmt::format("{}, above the yield friction {:.5g}; I = {:.4g} there",
                                      drive_text(layer),
                                      base.yield_stress / pressure,
                                      shear_rate / std::sqrt(pressure)),
                  .plug_mass = plug_edge(layer),
                  .condition_number = condition_number(layer, tau)};
  if (verdict.plug_mass > 0.0) {
    verdict.outcome = Outcome::plug;
    verdict.text += fmt::format("; the upper {:.3g} % of the mass move as a plug",
                                100.0 * verdict.plug_mass / layer.mass);
  }
  return verdict;
}

std::string rest_text(const Layer& layer, const FlowCurve& base) {
  return fmt::format("{}, not above the yield friction {:.5g}: the layer rests",
                     drive_text(layer),
                     base.yield_stress / layer.pressure(layer.mass));
}

std::string no_steady_text(const Layer& layer, const FlowCurve& base) {
  const double pressure = layer.pressure(layer.mass);
  if (no_friction_left(layer))
    return fmt::format(
        "softness (1 + Bo) p* = {:.4g} at the base takes all friction: f_p <= 0 from p_mu = {:.4g} "
        "on, where the law has no answer",
        confinement(layer.grains, pressure).softness,
        std::get<MuPhi>(layer.law).softness_friction->p_mu);
  return fmt::format("{}, not below the largest friction {:.5g} of the law there",
                     drive_text(layer),
                     base.largest_stress() / pressure);
}

std::string no_dense_state_text(const Layer& layer, const FlowCurve& base, double relative_I) {
  return fmt::format(
      "{}; it would take I = {:.4g} there, beyond I_phi = {:.4g} where the volume "
      "fraction vanishes",
      drive_text(layer),
      relative_I * base.I_phi,
      base.I_phi);
}

}  // namespace

FlowCurve Layer::curve(double mass_above) const {
  return std::visit([&](const auto& l) { return flow_curve(l, grains, pressure(mass_above)); },
                    law);
}

Layer make_layer(const RheologyTable& table, const ChuteCase& chute) {
  check(chute);
  const double d = chute.grains.diameter;
  const Units units{.length = d,
                    .time = std::sqrt(d / chute.gravity),
                    .mass_per_area = chute.grains.density * d,
                    .gravity = chute.gravity};
  const EffectiveBase base = table.base.value_or(EffectiveBase{});
  const double mass = chute.mass_per_area / units.mass_per_area - base.mass_below;
  if (!(mass > 0.0))
    throw std::invalid_argument(
        fmt::format("mass_per_area = {} is all below the effective base of the table (mass_below = "
                    "{} rho_p d): give a deeper layer, more than {:.4g}",
                    chute.mass_per_area,
                    base.mass_below,
                    base.mass_below * units.mass_per_area));
  constexpr double most = 1e60;  // beyond it powers of the mass are no numbers any more
  if (mass < 1.0 / most || mass > most)
    throw std::invalid_argument(fmt::format(
        "mass_per_area = {} is {:.3g} rho_p d: it must lie between {:g} and {:g} rho_p d",
        chute.mass_per_area,
        mass,
        1.0 / most,
        most));
  const double inclination = std::abs(chute.inclination);
  const double wall_drag = chute.walls ? 2.0 * chute.walls->friction * chute.walls->pressure_ratio *
                                             d / chute.walls->width
                                       : 0.0;
  return {.law = dimensionless(table.law, units),
          .grains = dimensionless(chute.grains, units),
          .units = units,
          .direction = chute.inclination < 0.0 ? -1.0 : 1.0,
          .inclination = inclination,
          .sine = std::sin(inclination),
          .cosine = std::cos(inclination),
          .mass = mass,
          .base_height = base.no_slip_height,
          .slip_length = chute.slip_length / d,
          .wall_drag = wall_drag};
}

double condition_number(const Layer& layer, double tau) {
  if (!std::holds_alternative<MuPhi>(layer.law)) return 0.0;
  const FlowCurve base = layer.curve(layer.mass);
  const double q = base.scaled_rate(tau).value_or(0.0);
  if (q == 0.0) return 0.0;
  return tau / (q * (1.0 + q / base.I_phi) * base.viscous_slope(q));  // tau / (I dtau/dI)
}

bool no_friction_left(const Layer& layer) {
  const auto* law = std::get_if<MuPhi>(&layer.law);
  return law && softness_factor(*law, confinement(layer.grains, layer.pressure(layer.mass))) <= 0.0;
}

Verdict steady_verdict(const Layer& layer) {
  if (layer.wall_drag > 0.0) return walled_verdict(layer);
  const FlowCurve base = layer.curve(layer.mass);
  const double tau = layer.driving_stress(layer.mass);
  if (no_friction_left(layer))
    return {.outcome = Outcome::no_steady, .text = no_steady_text(layer, base)};
  if (tau <= base.yield_stress)
    return {.outcome = Outcome::arrested, .text = rest_text(layer, base), .plug_mass = layer.mass};
  const double largest = tau * (1.0 + stress_rounding);
  const auto relative_I = base.relative_inertial_number(largest);
  if (!relative_I) return {.outcome = Outcome::no_steady, .text = no_steady_text(layer, base)};
  if (*relative_I >= 1.0 || !base.scaled_rate(largest))
    return {.outcome = Outcome::no_dense_state,
            .text = no_dense_state_text(layer, base, *relative_I)};
  return flowing(layer, base);
}

Profile in_case_units(const Layer& layer, Profile profile) {
  const Units& units = layer.units;
  const double velocity = layer.direction * units.velocity();
  for (ProfileRow& row : profile.rows) {
    row.z *= units.length;
    row.mass_above *= units.mass_per_area;
    row.velocity *= velocity;
    row.shear_rate *= layer.direction / units.time;
    row.shear_stress *= layer.direction * units.stress();
    row.pressure *= units.stress();
    row.velocity_error *= units.velocity();
  }
  profile.height *= units.length;
  profile.surface_velocity *= velocity;
  profile.flux *= velocity * units.length;
  profile.plug_mass *= units.mass_per_area;
  return profile;
}

}  // namespace grainlaw::continuum
