#include "apps/report/material_law.h"

#include <limits>

namespace grainlaw::report {

LawValue law_at(const continuum::RheologyTable& table, const calibration::State& state) {
  const auto* law = std::get_if<continuum::MuPhi>(&table.law);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (!law) return {nan, nan};
  const continuum::Confinement at{.softness = (1.0 + state.bond_number) * state.softness,
                                  .bond_number = state.bond_number};
  return {
      .friction = table.has_friction ? continuum::friction(*law, state.inertial_number, at) : nan,
      .volume_fraction = continuum::volume_fraction(*law, state.inertial_number, at)};
}

calibration::State state_of(const calibration::StatePoint& point) {
  return {point.inertial_number.value, point.softness.value, point.bond_number.value};
}

calibration::State without_cohesion(const calibration::State& state) {
  return {state.inertial_number, state.softness, 0.0};
}

LawValue residual(const MaterialReport& material, const calibration::StatePoint& point) {
  const LawValue law = law_at(material.fit.table, state_of(point));
  return {.friction = (point.friction.value - law.friction) / point.friction.error,
          .volume_fraction =
              (point.volume_fraction.value - law.volume_fraction) / point.volume_fraction.error};
}

}  // namespace grainlaw::report
