#pragma once

#include "apps/report/report.h"

namespace grainlaw::report {

/// mu and phi of a table at a state, or of a table that has no friction phi only (mu: NaN).
struct LawValue {
  double friction = 0.0;
  double volume_fraction = 0.0;
};
LawValue law_at(const continuum::RheologyTable& table, const calibration::State& state);

/// Where a point lies, and without its cohesion.
calibration::State state_of(const calibration::StatePoint& point);
calibration::State without_cohesion(const calibration::State& state);

/// What the fit leaves of a point, measured less law, in standard errors of what was measured.
LawValue residual(const MaterialReport& material, const calibration::StatePoint& point);

}  // namespace grainlaw::report
