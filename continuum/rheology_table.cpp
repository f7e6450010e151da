#include "continuum/rheology_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

namespace grainlaw::continuum {
namespace {

/// A coefficient of a table under its name; Value is double or const double.
template <class Value>
struct NamedCoefficient {
  std::string name;
  Value* value;
};

template <class Law, class Value>
void list(Law& law, std::vector<NamedCoefficient<Value>>& out) requires
    std::same_as<std::remove_const_t<Law>, GeneralisedBagnold> {
  out.insert(out.end(),
             {{"a", &law.a},
              {"b", &law.b},
              {"tau_c", &law.tau_c},
              {"volume_fraction", &law.volume_fraction}});
}

template <class Law, class Value>
void list(Law& law, std::vector<NamedCoefficient<Value>>& out) requires
    std::same_as<std::remove_const_t<Law>, MuPhi> {
  auto& mu = law.friction;
  if (!mu.tabulated)
    out.insert(out.end(), {{"mu0", &mu.mu0}, {"beta", &mu.beta}, {"kappa", &mu.kappa}});
  if (auto& exponent = mu.exponent) out.push_back({"exponent", &*exponent});
  if (auto& soft = law.softness_friction) out.push_back({"p_mu", &soft->p_mu});
  if (auto& c = law.cohesion_friction)
    out.insert(out.end(), {{"cohesion_alpha", &c->alpha}, {"cohesion_beta", &c->beta}});
  if (auto& c = law.cohesion_stress) {
    out.push_back({"cohesion_factor", &c->factor});
    if (auto& b = c->bond_exponent) out.push_back({"cohesion_bond_exponent", &*b});
    if (auto& g = c->softness_exponent) out.push_back({"cohesion_softness_exponent", &*g});
  }
  auto& phi = law.volume_fraction;
  out.insert(out.end(), {{"phi0", &phi.phi0}, {"I_phi", &phi.I_phi}});
  if (auto& soft = law.softness_volume_fraction) out.push_back({"p_phi", &soft->p_phi});
  if (auto& c = law.cohesion_volume_fraction)
    out.insert(out.end(), {{"p1", &c->p1}, {"p2", &c->p2}, {"p3", &c->p3}, {"p4", &c->p4}});
}

template <class Table>
auto coefficients(Table& table) {
  using Value = std::conditional_t<std::is_const_v<Table>, const double, double>;
  std::vector<NamedCoefficient<Value>> out;
  std::visit([&](auto& law) { list(law, out); }, table.law);
  if (!table.has_friction)
    std::erase_if(out, [](const auto& entry) {
      return entry.name == "mu0" || entry.name == "beta" || entry.name == "kappa" ||
             entry.name == "exponent";
    });
  if (auto& base = table.base)
    out.insert(out.end(),
               {{"no_slip_height", &base->no_slip_height}, {"mass_below", &base->mass_below}});
  return out;
}

template <class Table>
auto& find_coefficient(Table& table, const std::string& name) {
  for (const auto& entry : coefficients(table))
    if (entry.name == name) return *entry.value;
  std::string known;
  for (const auto& existing : coefficient_names(table)) known += " " + existing;
  throw TableError(fmt::format("'{}' is no coefficient of this table; it has{}", name, known));
}

void require(bool holds, const char* name, double value, const std::string& bound) {
  if (!holds) throw TableError(fmt::format("{} = {} must be {}", name, value, bound));
}

void require_not_negative(const char* name, double value) {
  require(std::isfinite(value) && value >= 0.0, name, value, "finite and not negative");
}

void require_positive(const char* name, double value) {
  require(std::isfinite(value) && value > 0.0, name, value, "finite and positive");
}

void require_volume_fraction(const char* name, double value) {
  require(value >= loosest_volume_fraction && value < 1.0,
          name,
          value,
          fmt::format("at least {}, and below 1", loosest_volume_fraction));
}

void validate_law(const GeneralisedBagnold& law) {
  require_not_negative("a", law.a);
  require_not_negative("b", law.b);
  require_not_negative("tau_c", law.tau_c);
  require_volume_fraction("volume_fraction", law.volume_fraction);
  require(law.inclination >= 0.0 && law.inclination < 0.5 * std::numbers::pi,
          "inclination",
          law.inclination,
          "between 0 and pi/2");
  if (law.a == 0.0 && law.b == 0.0)
    throw TableError(
        "a = 0 and b = 0: no stress resists a change of the shear rate, so none is determined; "
        "give a > 0 (Bagnold) or b > 0 (linear)");
}

void validate_friction(const InertialFriction& law) {
  if (law.tabulated) return;  // rises, or it would not exist
  require_not_negative("mu0", law.mu0);
  require_not_negative("beta", law.beta);  // negative: mu falls with I and the flow is ill-posed
  require(law.beta <= steepest_friction,
          "beta",
          law.beta,
          fmt::format("at most {:g}, the slope of mu(I) at rest, (mu_inf - mu0)/I_mu; grains "
                      "have one near 1",
                      steepest_friction));
  require_not_negative("kappa", law.kappa);
  if (law.exponent)
    require(std::isfinite(*law.exponent) && *law.exponent >= least_exponent,
            "exponent",
            *law.exponent,
            fmt::format("finite and at least {}", least_exponent));
  if (law.mu0 == 0.0 && law.beta == 0.0)
    throw TableError("mu0 = 0 and beta = 0: a fluid without stress; give mu0 > 0 or beta > 0");
}

void validate_cohesion(const CohesionVolumeFraction& law) {
  for (int i = 0; i <= 500; ++i) {  // a quartic: 501 points leave no room for a hidden root
    const double Bo = largest_fitted_bond_number * i / 500.0;
    const double g = cohesion_volume_fraction(law.p1, law.p2, law.p3, law.p4, Bo);
    if (!(g > 0.0))
      throw TableError(fmt::format(
          "p1..p4 make the volume fraction vanish at Bo = {:.3g} (g_c = {:.3g}); it must stay "
          "positive up to Bo = {}",
          Bo,
          g,
          largest_fitted_bond_number));
  }
}

/// Friction must not rise with depth, where Bo falls as 1/p and p* rises as p: g <= b, and g <= 1
/// beyond Bo = 5, where Bo^b goes on as a straight line.
void validate_cohesion(const CohesionStress& law) {
  require_not_negative("cohesion_factor", law.factor);
  if (law.bond_exponent) require_positive("cohesion_bond_exponent", *law.bond_exponent);
  const double g = law.softness_exponent.value_or(0.0);
  require_not_negative("cohesion_softness_exponent", g);
  const double most = std::min(law.bond_exponent.value_or(1.0), 1.0);
  if (g > most)
    throw TableError(fmt::format(
        "cohesion_softness_exponent = {} is above {}, the smaller of 1 and the exponent of Bo: the "
        "yield friction of grains of one adhesion would rise with depth",
        g,
        most));
}

void validate_law(const GeneralisedBagnold& law, bool) {
  validate_law(law);
}

void validate_law(const MuPhi& law, bool has_friction) {
  if (has_friction) validate_friction(law.friction);
  if (const auto& soft = law.softness_friction) require_positive("p_mu", soft->p_mu);
  if (const auto& c = law.cohesion_friction) {
    require_not_negative("cohesion_alpha", c->alpha);
    require_positive("cohesion_beta", c->beta);
  }
  if (const auto& c = law.cohesion_stress) {
    validate_cohesion(*c);
    if (law.cohesion_friction)
      throw TableError(
          "cohesion_friction and cohesion_stress are two laws for the same thing: give one");
  }
  require_volume_fraction("phi0", law.volume_fraction.phi0);
  require(law.volume_fraction.I_phi > 0.0, "I_phi", law.volume_fraction.I_phi, "positive");
  if (const auto& soft = law.softness_volume_fraction) require_positive("p_phi", soft->p_phi);
  if (const auto& c = law.cohesion_volume_fraction) validate_cohesion(*c);
}

void validate_range(const char* name, const std::optional<Range>& range) {
  if (range && !(range->lower >= 0.0 && range->lower <= range->upper))
    throw TableError(
        fmt::format("the range of {} runs from {} to {}; it must be ordered and not negative",
                    name,
                    range->lower,
                    range->upper));
}

void validate_names(const RheologyTable& table, const Covariance& covariance) {
  std::set<std::string> seen;
  for (const auto& name : covariance.names) {
    coefficient(table, name);  // throws for a name the table does not have
    if (!seen.insert(name).second)
      throw TableError(fmt::format("the covariance names '{}' twice", name));
  }
  const std::size_t n = covariance.names.size();
  if (covariance.matrix.size() != n * n)
    throw TableError(fmt::format("the covariance of {} coefficients needs {} numbers, not {}",
                                 n,
                                 n * n,
                                 covariance.matrix.size()));
}

/// Rounding of a covariance written with 10 digits or more, in units of correlation.
constexpr double correlation_rounding = 1e-9;

/// Correlation matrix, row-major; rows of coefficients without variance are zero.
std::vector<double> correlation(const Covariance& covariance) {
  const std::size_t n = covariance.names.size();
  std::vector<double> result(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double scale = std::sqrt(covariance(i, i)) * std::sqrt(covariance(j, j));
      if (!std::isfinite(covariance(i, j)) || (!(scale > 0.0) && covariance(i, j) != 0.0))
        throw TableError(fmt::format("covariance of {} and {} is {} with variances {} and {}",
                                     covariance.names[i],
                                     covariance.names[j],
                                     covariance(i, j),
                                     covariance(i, i),
                                     covariance(j, j)));
      if (scale > 0.0) result[i * n + j] = covariance(i, j) / scale;
    }
  }
  return result;
}

/// Gaussian elimination with the largest diagonal entry as pivot: the matrix is positive
/// semidefinite if no pivot is negative and, once the largest is zero, nothing else is left.
bool positive_semidefinite(std::vector<double> m, std::size_t n) {
  const double rounding = correlation_rounding * static_cast<double>(n);
  std::vector<bool> done(n, false);
  for (std::size_t step = 0; step < n; ++step) {
    std::size_t pivot = n;
    for (std::size_t i = 0; i < n; ++i) {
      if (done[i]) continue;
      if (m[i * n + i] < -rounding) return false;
      if (pivot == n || m[i * n + i] > m[pivot * n + pivot]) pivot = i;
    }
    done[pivot] = true;
    if (m[pivot * n + pivot] <= rounding) {
      for (std::size_t i = 0; i < n; ++i)  // |m_ij| <= sqrt(m_ii m_jj) <= rounding must hold
        if (!done[i] && std::abs(m[i * n + pivot]) > rounding) return false;
      continue;
    }
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        if (!done[i] && !done[j])
          m[i * n + j] -= m[i * n + pivot] * m[pivot * n + j] / m[pivot * n + pivot];
  }
  return true;
}

void validate_covariance(const RheologyTable& table, const Covariance& covariance) {
  validate_names(table, covariance);
  const std::size_t n = covariance.names.size();
  const auto m = correlation(covariance);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(m[i * n + j] - m[j * n + i]) > correlation_rounding)
        throw TableError(fmt::format("the covariance is not symmetric in {} and {}",
                                     covariance.names[i],
                                     covariance.names[j]));
  if (!positive_semidefinite(m, n))
    throw TableError("the covariance has a negative eigenvalue: no errors scatter like that");
}

}  // namespace

void validate(const RheologyTable& table) {
  validate_coefficients(table);
  if (!table.has_friction)
    throw TableError(
        fmt::format("this table has phi only: its source gives no friction for mu_p = {:.3g}, so "
                    "phi(I, p*, Bo) "
                    "follows from it but no flow",
                    table.contact_friction));
}

void validate_coefficients(const RheologyTable& table) {
  std::visit([&](const auto& law) { validate_law(law, table.has_friction); }, table.law);
  if (table.base) {
    require_not_negative("no_slip_height", table.base->no_slip_height);
    require_not_negative("mass_below", table.base->mass_below);
  }
  validate_range("I", table.range.inertial_number);
  validate_range("p*", table.range.softness);
  validate_range("Bo", table.range.bond_number);
  if (table.covariance) validate_covariance(table, *table.covariance);
}

void require_continuous_yield(const std::variant<GeneralisedBagnold, MuPhi>& law) {
  const auto* material = std::get_if<MuPhi>(&law);
  const MonotoneCurve* curve = material ? material->friction.tabulated.get() : nullptr;
  if (curve && curve->x().front() > 0.0)
    throw TableError(
        fmt::format("the tabulated mu(I) begins at I = {}: a flow in time starts or ends at I = 0; "
                    "give a pair there, or ask for the steady flow only (answer = \"steady\")",
                    curve->x().front()));
}

std::vector<std::string> coefficient_names(const RheologyTable& table) {
  std::vector<std::string> names;
  for (const auto& entry : coefficients(table)) names.push_back(entry.name);
  return names;
}

double coefficient(const RheologyTable& table, const std::string& name) {
  return find_coefficient(table, name);
}

void set_coefficient(RheologyTable& table, const std::string& name, double value) {
  find_coefficient(table, name) = value;
}

}  // namespace grainlaw::continuum
