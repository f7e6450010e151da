#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "continuum/chute_1d.h"
#include "continuum/layer.h"
#include "continuum/range_flags.h"
#include "continuum/steady_profile.h"
#include "continuum/walled_layer.h"

namespace grainlaw::continuum {
namespace {

struct GaussPoint {
  double position;
  double weight;
};
/// Gauss-Legendre with 6 points on [-1, 1], positive half: exact to degree 11.
constexpr std::array<GaussPoint, 3> gauss = {{{0.2386191860831969, 0.4679139345726910},
                                              {0.6612093864662645, 0.3607615730481386},
                                              {0.9324695142031521, 0.1713244923791704}}};

/// M(s) = origin + (linear r + quadratic r^2) / scale, r = s or s^2: a variable in which the
/// integrands have no singularity, so that Gauss converges down to rounding.
struct Substitution {
  double origin = 0.0;
  double linear = 0.0;
  double quadratic = 0.0;
  double scale = 1.0;
  bool squared = false;

  double mass(double s) const {
    const double r = squared ? s * s : s;
    return origin + r * (linear + quadratic * r) / scale;
  }
  double slope(double s) const {
    const double r = squared ? s * s : s;
    return (linear + 2.0 * quadratic * r) / scale * (squared ? 2.0 * s : 1.0);
  }
  double variable(double mass_above) const {
    const double r = bagnold_shear_rate(quadratic, linear, scale * (mass_above - origin));
    return squared ? std::sqrt(r) : r;
  }
};

/// In the sheared part: s = gd for the generalised Bagnold law, which makes the integrands
/// polynomials, and s = sqrt(M) for mu(I) laws, whose terms are analytic in sqrt(p). A power law
/// makes I ~ (M - M_c)^(1/n) at the edge of a plug: s is the fourth root of the distance from
/// there.
Substitution sheared(const Layer& layer, double plug_mass) {
  if (const auto* law = std::get_if<GeneralisedBagnold>(&layer.law))
    return {.origin = plug_mass, .linear = law->b, .quadratic = law->a, .scale = layer.sine};
  const bool power_law = std::get<MuPhi>(layer.law).friction.exponent.has_value();
  if (power_law && plug_mass > 0.0) return {.origin = plug_mass, .quadratic = 1.0, .squared = true};
  return {.quadratic = 1.0};
}

/// In the plug nothing but phi varies, smoothly in M.
constexpr Substitution plug{.linear = 1.0};

struct Integrals {
  double velocity = 0.0;  ///< int |du/dM| dM
  double height = 0.0;    ///< int dM / phi
  double flux = 0.0;      ///< int M |du/dM| dM = int u dM by parts

  Integrals& operator+=(const Integrals& other) {
    velocity += other.velocity;
    height += other.height;
    flux += other.flux;
    return *this;
  }
};

Integrals integrand(const Layer& layer, double mass_above, double weight) {
  const FlowCurve curve = layer.curve(mass_above);
  const double q = curve.scaled_rate(layer.driving_stress(mass_above)).value();
  const double velocity = weight * q / curve.mobility;
  return {velocity, weight / curve.volume_fraction(q), mass_above * velocity};
}

/// Composite Gauss quadrature over a layer, in panels of equal length in s.
class Quadrature {
 public:
  Quadrature(const Layer& layer, double plug_mass, int panels)
      : layer_(layer),
        plug_mass_(plug_mass),
        sheared_(sheared(layer, plug_mass)),
        sheared_panel_((sheared_.variable(layer.mass) - sheared_.variable(plug_mass)) / panels),
        plug_panel_(plug_mass / panels) {
    add_breaks();
  }

  Integrals between(double above, double below) const {
    Integrals sum;
    for (const double edge : breaks_) {
      if (edge <= above || edge >= below) continue;
      sum += smooth_part(above, edge);
      above = edge;
    }
    return sum += smooth_part(above, below);
  }

 private:
  /// Laws have a kink where their cohesion terms are continued beyond the largest fitted Bo, and
  /// there and at the plug edge they vary with ln M: panels must not reach further than to sqrt(2)
  /// times the mass above, as long as they are not shorter anyway.
  void add_breaks() {
    const double adhesion = layer_.grains.adhesion.value_or(0.0);
    const double kink = adhesion / (largest_fitted_bond_number * layer_.cosine);
    if (plug_mass_ > 0.0) breaks_.push_back(plug_mass_);
    if (adhesion > 0.0 && std::holds_alternative<MuPhi>(layer_.law)) {
      breaks_.push_back(kink);
      const double panel = std::min(0.1 * layer_.mass, sheared_panel_ * sheared_panel_);
      const double first = plug_mass_ > 0.0 ? std::min(plug_mass_, kink) : kink;
      for (double at = first; at < 0.5 * layer_.mass && at < 16.0 * panel;
           at *= std::numbers::sqrt2)
        breaks_.push_back(std::numbers::sqrt2 * at);
    }
    std::sort(breaks_.begin(), breaks_.end());
  }

  Integrals smooth_part(double above, double below) const {
    const bool flows = above >= plug_mass_;
    const Substitution& m = flows ? sheared_ : plug;
    const double start = m.variable(above);
    const double length = m.variable(below) - start;
    const int panels =
        std::max(1, static_cast<int>(std::ceil(length / (flows ? sheared_panel_ : plug_panel_))));
    Integrals sum;
    for (int i = 0; i < panels; ++i)
      sum += panel(m, start + length * (i + 0.5) / panels, 0.5 * length / panels);
    return sum;
  }

  Integrals panel(const Substitution& m, double centre, double half) const {
    Integrals sum;
    for (const auto& point : gauss)
      for (const double side : {-1.0, 1.0}) {
        const double s = centre + side * half * point.position;
        sum += integrand(layer_, m.mass(s), half * point.weight * m.slope(s));
      }
    return sum;
  }

  const Layer& layer_;
  double plug_mass_;
  Substitution sheared_;
  double sheared_panel_;
  double plug_panel_;
  std::vector<double> breaks_;
};

ProfileRow row_at(const Layer& layer, double mass_above, const Integrals& from_base) {
  const double at = std::max(mass_above, layer.surface_mass());
  const FlowCurve curve = layer.curve(at);
  const double q = curve.scaled_rate(layer.driving_stress(at)).value();
  return {.z = layer.base_height + from_base.height,
          .mass_above = mass_above,
          .velocity = from_base.velocity,
          .shear_rate = mass_above > 0.0 ? curve.shear_rate(q) : 0.0,
          .shear_stress = layer.driving_stress(mass_above),
          .pressure = layer.pressure(mass_above),
          .volume_fraction = curve.volume_fraction(q),
          .inertial_number = curve.shear_rate(q) / std::sqrt(layer.pressure(at))};
}

void check(const SteadyOptions& options) {
  if (options.panels < 1 || options.rows < 2)
    throw std::invalid_argument(fmt::format(
        "panels = {} must be at least 1, rows = {} at least 2", options.panels, options.rows));
}

}  // namespace

Profile steady_profile(const Layer& layer, double plug_mass, const SteadyOptions& options) {
  if (layer.wall_drag > 0.0) return walled_profile(layer, options.rows);
  const Quadrature quadrature(layer, plug_mass, options.panels);
  const auto mass_of_row = [&](int i) {
    return layer.mass * (options.rows - 1 - i) / (options.rows - 1);
  };
  Profile profile;
  Integrals sum;
  const FlowCurve base = layer.curve(layer.mass);
  sum.velocity = layer.slip_length *
                 base.shear_rate(base.scaled_rate(layer.driving_stress(layer.mass)).value());
  sum.flux = sum.velocity * layer.mass;
  profile.rows.reserve(static_cast<std::size_t>(options.rows));
  profile.rows.push_back(row_at(layer, layer.mass, sum));
  for (int i = 1; i < options.rows; ++i) {
    sum += quadrature.between(mass_of_row(i), mass_of_row(i - 1));
    profile.rows.push_back(row_at(layer, mass_of_row(i), sum));
  }
  profile.height = profile.rows.back().z;
  profile.surface_velocity = sum.velocity;
  profile.flux = sum.flux;
  profile.plug_mass = plug_mass;
  return profile;
}

SteadyChute steady_chute(const RheologyTable& table,
                         const ChuteCase& chute,
                         const SteadyOptions& options) {
  validate(table);
  check(options);
  const Layer layer = make_layer(table, chute);
  Verdict verdict = steady_verdict(layer);
  SteadyChute result;
  result.answer.outcome = verdict.outcome;
  result.answer.text = std::move(verdict.text);
  result.answer.condition_number = verdict.condition_number;
  Profile profile;
  if (flows(verdict.outcome)) profile = steady_profile(layer, verdict.plug_mass, options);
  result.answer.out_of_domain = range_flags(layer, table, profile);
  result.profile = in_case_units(layer, std::move(profile));
  return result;
}

}  // namespace grainlaw::continuum
