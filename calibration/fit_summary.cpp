#include "calibration/fit_summary.h"

#include <algorithm>

namespace grainlaw::calibration {

const FittedCoefficient& FitSummary::operator[](const std::string& name) const {
  const auto found = std::find_if(coefficients.begin(),
                                  coefficients.end(),
                                  [&](const FittedCoefficient& c) { return c.name == name; });
  if (found == coefficients.end())
    throw std::out_of_range("the fit has no coefficient '" + name + "'");
  return *found;
}

}  // namespace grainlaw::calibration
