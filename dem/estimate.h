#pragma once

#include <limits>

namespace grainlaw::dem {

/// A measured number and its standard error, both in the unit of the quantity. Both NaN where
/// nothing was measured.
struct Estimate {
  double value = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace grainlaw::dem
