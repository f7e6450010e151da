#include "continuum/well_posedness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "continuum/flow_curve.h"

namespace grainlaw::continuum {
namespace {

constexpr int points_per_decade = 40;

WellPosedness judge(const StressResponse& response, double shear_rate) {
  return well_posedness(shear_rate * response.by_shear_rate / response.stress,
                        response.by_pressure);
}

std::optional<WellPosedness> judge(const GeneralisedBagnold& law, const FlowState& at) {
  return judge(stress_response(law, {}, at.inertial_number, 1.0), at.inertial_number);
}

/// In units d = rho_p = p = 1 the shear rate is I, k_n = 1 / p* and f_a = Bo.
std::optional<WellPosedness> judge(const MuPhi& law, const FlowState& at) {
  GrainProperties grains;
  if (at.softness > 0.0) grains.stiffness = 1.0 / at.softness;
  if (at.bond_number > 0.0) grains.adhesion = at.bond_number;
  if (softness_factor(law, confinement(grains, 1.0)) <= 0.0) return std::nullopt;
  return judge(stress_response(law, grains, at.inertial_number, 1.0), at.inertial_number);
}

/// Where holds() changes between two inertial numbers.
template <class Holds>
double edge_between(double low, double high, bool holds_low, Holds holds) {
  while (high / low > 1.0 + 1e-10) {
    const double middle = std::sqrt(low * high);
    (holds(middle) == holds_low ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

template <class Holds>
std::vector<Range> intervals_where(Holds holds) {
  const auto [first, last] = searched_inertial_numbers;
  const int points = static_cast<int>(points_per_decade * std::log10(last / first));
  std::vector<Range> intervals;
  double previous = first;
  bool inside = holds(first);
  if (inside) intervals.push_back({0.0, std::numeric_limits<double>::infinity()});
  for (int i = 1; i <= points; ++i) {
    const double I = first * std::pow(last / first, static_cast<double>(i) / points);
    if (holds(I) != inside) {
      const double edge = edge_between(previous, I, inside, holds);
      if (inside)
        intervals.back().upper = edge;
      else
        intervals.push_back({edge, std::numeric_limits<double>::infinity()});
      inside = !inside;
    }
    previous = I;
  }
  return intervals;
}

/// 0 and those of the values that lie in the range; all where none is stated.
std::vector<double> covered(std::vector<double> values, const std::optional<Range>& range) {
  if (range) std::erase_if(values, [&](double x) { return x > range->upper; });
  values.insert(values.begin(), 0.0);
  return values;
}

bool depends_on_cohesion(const MuPhi& law) {
  return law.cohesion_friction || law.cohesion_stress;
}

bool depends_on_softness(const MuPhi& law) {
  return law.softness_friction || (law.cohesion_stress && law.cohesion_stress->softness_exponent);
}

double margin_with(RheologyTable table,
                   const std::string& name,
                   double value,
                   const FlowState& at,
                   double otherwise) {
  set_coefficient(table, name, value);
  const auto moved = well_posedness(table, at);
  return moved ? moved->margin : otherwise;
}

/// Change of F by one standard error of a coefficient, from a step of a hundredth of it; F is
/// smooth, so the step leaves 1e-4 of the change.
double margin_change(const RheologyTable& table,
                     const std::string& name,
                     double error,
                     const FlowState& at,
                     double margin) {
  constexpr double step = 1e-2;
  const double value = coefficient(table, name);
  const double high = margin_with(table, name, value + step * error, at, margin);
  const double low = margin_with(table, name, value - step * error, at, margin);
  return (high - low) / (2.0 * step);
}

double margin_error(const RheologyTable& table, const FlowState& at, double margin) {
  const Covariance& covariance = *table.covariance;
  const std::size_t n = covariance.names.size();
  std::vector<double> change(n, 0.0);
  std::vector<double> error(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    error[i] = std::sqrt(covariance(i, i));
    if (error[i] > 0.0) change[i] = margin_change(table, covariance.names[i], error[i], at, margin);
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (error[i] > 0.0 && error[j] > 0.0)
        variance += change[i] * covariance(i, j) / (error[i] * error[j]) * change[j];
  return std::sqrt(std::max(0.0, variance));  // a zero eigenvalue may end at -1e-17
}

double normal_below_zero(double mean, double error) {
  if (error == 0.0) return mean < 0.0 ? 1.0 : 0.0;
  return 0.5 * std::erfc(mean / error / std::numbers::sqrt2);
}

FlowState state_of(const ProfileRow& row,
                   const GrainProperties& grains,
                   const RheologyTable& table) {
  const bool bagnold = std::holds_alternative<GeneralisedBagnold>(table.law);
  const double d = grains.diameter;
  return {.inertial_number = bagnold ? row.shear_rate : row.inertial_number,
          .softness = grains.stiffness ? row.pressure * d / *grains.stiffness : 0.0,
          .bond_number = grains.adhesion.value_or(0.0) / (row.pressure * d * d)};
}

}  // namespace

WellPosedness well_posedness(double q, double r) {
  WellPosedness result{.rate_exponent = q, .pressure_slope = r};
  const bool between_the_axes = q < 1.0 && std::abs(r) <= 2.0 * (1.0 - q);
  result.direction = between_the_axes ? r / (2.0 * (1.0 - q)) : std::copysign(1.0, r);
  result.margin = between_the_axes ? q - r * r / (4.0 * (1.0 - q)) : 1.0 - std::abs(r);
  return result;
}

std::optional<WellPosedness> well_posedness(const RheologyTable& table, const FlowState& at) {
  return std::visit([&](const auto& law) { return judge(law, at); }, table.law);
}

std::vector<Range> well_posed_intervals(const RheologyTable& table,
                                        double softness,
                                        double bond_number) {
  return intervals_where([&](double I) {
    const auto found = well_posedness(table, {I, softness, bond_number});
    return found && found->holds();
  });
}

std::vector<CertifiedConfinement> well_posedness_map(const RheologyTable& table) {
  const auto* law = std::get_if<MuPhi>(&table.law);
  if (!law) return {{.intervals = well_posed_intervals(table, 0.0, 0.0)}};
  std::vector<double> softnesses{0.0};
  std::vector<double> bond_numbers{0.0};
  if (depends_on_softness(*law)) softnesses = covered({1e-3, 1e-2, 1e-1}, table.range.softness);
  if (depends_on_cohesion(*law))
    bond_numbers = covered({1.0, 2.0, largest_fitted_bond_number}, table.range.bond_number);
  std::vector<CertifiedConfinement> map;
  for (const double Bo : bond_numbers)
    for (const double softness : softnesses)
      map.push_back({softness, Bo, well_posed_intervals(table, softness, Bo)});
  return map;
}

std::optional<CertifiedState> certify(const RheologyTable& table, const FlowState& at) {
  const auto found = well_posedness(table, at);
  if (!found) return std::nullopt;
  CertifiedState state{.at = at, .well_posedness = *found};
  if (table.covariance) {
    state.margin_error = margin_error(table, at, found->margin);
    state.ill_posed_probability = normal_below_zero(found->margin, *state.margin_error);
  }
  return state;
}

std::optional<CertifiedFlow> certify(const RheologyTable& table,
                                     const Profile& profile,
                                     const GrainProperties& grains) {
  std::optional<FlowState> worst;
  double least = std::numeric_limits<double>::infinity();
  double sheared = 0.0;
  double ill_posed = 0.0;
  for (const ProfileRow& row : profile.rows) {
    if (!(row.shear_rate != 0.0 && row.pressure > 0.0)) continue;
    const FlowState at = state_of(row, grains, table);
    const auto found = well_posedness(table, at);
    if (!found) continue;
    sheared += 1.0;
    if (!found->holds()) ill_posed += 1.0;
    if (found->margin < least) worst = at;
    least = std::min(least, found->margin);
  }
  if (!worst) return std::nullopt;
  return CertifiedFlow{*certify(table, *worst), ill_posed / sheared};
}

}  // namespace grainlaw::continuum
