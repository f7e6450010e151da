#include "calibration/refit.h"

#include <algorithm>
#include <cmath>

#include "calibration/material_laws.h"

namespace grainlaw::calibration {

ChosenLaw chosen_law(const MaterialFit& fit, Quantity quantity) {
  const bool friction = quantity == Quantity::friction;
  ChosenLaw chosen{.quantity = quantity, .law = {}, .active = {}};
  chosen.law = friction ? friction_law(form_of(std::get<continuum::MuPhi>(fit.table.law)))
                        : volume_fraction_law();
  for (const FittedCoefficient& c : (friction ? fit.friction : fit.volume_fraction).coefficients) {
    const auto& slots = chosen.law.slots;
    const auto found = std::find_if(
        slots.begin(), slots.end(), [&](const Slot& slot) { return slot.name == c.name; });
    if (found != slots.end()) {
      chosen.active.push_back(static_cast<std::size_t>(found - slots.begin()));
    }
  }
  return chosen;
}

const std::vector<double>& weights_of(const MaterialFit& fit, Quantity quantity) {
  return quantity == Quantity::friction ? fit.friction_weight : fit.fraction_weight;
}

std::vector<dem::Estimate> table_coefficients(const FittableLaw& law, const SolvedLaw& solved) {
  const Matrix covariance = table_covariance(law, solved);
  std::vector<dem::Estimate> result;
  for (std::size_t k = 0; k < solved.active.size(); ++k) {
    const int j = static_cast<int>(k);
    result.push_back({std::pow(solved.minimum.values[k], law.slots[solved.active[k]].power),
                      std::sqrt(covariance(j, j))});
  }
  return result;
}

}  // namespace grainlaw::calibration
