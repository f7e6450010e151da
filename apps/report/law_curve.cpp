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

}  // namespace

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
