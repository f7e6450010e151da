#include "apps/report/law_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using continuum::Confinement;

const continuum::MuPhi& mu_phi(const continuum::RheologyTable& table) {
  return std::get<continuum::MuPhi>(table.law);
}

/// Central difference over a hundredth of a standard error: small against the curvature of the
/// laws, large against rounding.
double derivative(const continuum::RheologyTable& table,
                  const std::string& name,
                  double standard_error,
                  const std::function<double(const continuum::RheologyTable&)>& number) {
  const double step = 0.01 * standard_error;
  if (!(step > 0.0)) return 0.0;
  const double value = continuum::coefficient(table, name);
  continuum::RheologyTable shifted = table;
  continuum::set_coefficient(shifted, name, value + step);
  const double above = number(shifted);
  continuum::set_coefficient(shifted, name, value - step);
  return (above - number(shifted)) / (2.0 * step);
}

}  // namespace

dem::Estimate propagated(const continuum::RheologyTable& table,
                         const std::function<double(const continuum::RheologyTable&)>& number) {
  if (!table.covariance) return {.value = number(table), .error = nan};
  const continuum::Covariance& covariance = *table.covariance;
  const std::size_t size = covariance.names.size();
  std::vector<double> slope(size);
  double variance = 0.0;
  for (std::size_t i = 0; i < size; ++i) {
    slope[i] = derivative(table, covariance.names[i], std::sqrt(covariance(i, i)), number);
  }
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) variance += slope[i] * covariance(i, j) * slope[j];
  }
  return {.value = number(table), .error = std::sqrt(std::max(0.0, variance))};
}

std::vector<LawPoint> law_curve(const continuum::RheologyTable& table,
                                const continuum::Range& inertial_number,
                                double softness,
                                std::size_t points) {
  std::vector<LawPoint> curve;
  if (!std::holds_alternative<continuum::MuPhi>(table.law)) return curve;
  const Confinement at{.softness = softness};
  for (std::size_t k = 0; k < points; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(points - 1);
    const double I = std::lerp(inertial_number.lower, inertial_number.upper, share);
    const auto mu = [&](const auto& t) { return continuum::friction(mu_phi(t), I, at); };
    const auto phi = [&](const auto& t) { return continuum::volume_fraction(mu_phi(t), I, at); };
    curve.push_back({.inertial_number = I,
                     .friction = propagated(table, mu),
                     .volume_fraction = propagated(table, phi)});
  }
  return curve;
}

dem::Estimate inertial_number_at(const continuum::RheologyTable& table,
                                 double inclination,
                                 double softness) {
  if (!std::holds_alternative<continuum::MuPhi>(table.law)) return {};
  return propagated(table, [&](const continuum::RheologyTable& t) {
    const continuum::MuPhi& law = mu_phi(t);
    const double mu =
        std::tan(inclination) / continuum::friction_factor(law, Confinement{.softness = softness});
    const double I = continuum::inertial_number_of(law.friction, mu);
    return I > 0.0 ? I : nan;
  });
}

std::vector<Coefficient> coefficients(const continuum::RheologyTable& table) {
  std::vector<Coefficient> result;
  for (const std::string& name : continuum::coefficient_names(table)) {
    Coefficient coefficient{
        .name = name, .estimate = {.value = continuum::coefficient(table, name), .error = nan}};
    if (table.covariance) {
      const auto& names = table.covariance->names;
      const auto found = std::find(names.begin(), names.end(), name);
      const auto i = static_cast<std::size_t>(found - names.begin());
      if (found != names.end()) {
        coefficient.estimate.error = std::sqrt((*table.covariance)(i, i));
      }
    }
    result.push_back(coefficient);
  }
  return result;
}

}  // namespace grainlaw::report
