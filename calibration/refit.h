#pragma once

#include <span>
#include <vector>

#include "calibration/law_selection.h"
#include "calibration/material_fit.h"
#include "calibration/state_points.h"

namespace grainlaw::calibration {

/// One law of a finished fit with the terms it was left with: what it takes to fit it again, to
/// other data of the same kind.
struct ChosenLaw {
  Quantity quantity = Quantity::friction;
  FittableLaw law;
  std::vector<std::size_t> active;
};
ChosenLaw chosen_law(const MaterialFit& fit, Quantity quantity);

/// Weights that a fit gave its points, in one law.
const std::vector<double>& weights_of(const MaterialFit& fit, Quantity quantity);

/// Coefficients of the table with their standard errors, in the order of `active`.
std::vector<dem::Estimate> table_coefficients(const FittableLaw& law, const SolvedLaw& solved);

}  // namespace grainlaw::calibration
