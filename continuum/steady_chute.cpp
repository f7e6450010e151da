#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "continuum/chute_1d.h"
#include "continuum/layer.h"
#include "continuum/range_flags.h"
#include "continuum/steady_profile.h"

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

/// M(s) = origin + (linear s + quadratic s^2) / scale: a variable in which the integrands have no
/// singularity, so that Gauss converges down to rounding.
struct Substitution {
  double origin = 0.0;
  double linear = 0.0;
  double quadratic = 0.0;
  double scale = 1.0;

  double mass(double s) const { return origin + s * (linear + quadratic * s) / scale; }
  double slope(double s) const { return (linear + 2.0 * quadratic * s) / scale; }
  double variable(double mass_above) const {
    return bagnold_shear_rate(quadratic, linear, scale * (mass_above - origin));
  }
};

/// In the sheared part: s = gd for the generalised Bagnold law, which makes the integrands
/// polynomials, and s = sqrt(M) for mu(I) laws, whose terms are analytic in sqrt(p).
Substitution sheared(const Layer& layer, double plug_mass) {
  if (const auto* law = std::get_if<GeneralisedBagnold>(&layer.law))
    return {.origin = plug_mass, .linear = law->b, .quadratic = law->a, .scale = layer.sine};
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
    // Laws have a kink where their cohesion terms are continued beyond the largest fitted Bo.
    const double kink =
        layer.grains.adhesion.value_or(0.0) / (largest_fitted_bond_number * layer.cosine);
    breaks_ = {std::min(plug_mass, kink), std::max(plug_mass, kink)};
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
  std::array<double, 2> breaks_{};
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
  const Quadrature quadrature(layer, plug_mass, options.panels);
  const auto mass_of_row = [&](int i) {
    return layer.mass * (options.rows - 1 - i) / (options.rows - 1);
  };
  Profile profile;
  Integrals sum;
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
