#pragma once

#include <string>
#include <vector>

#include "continuum/homogeneous_shear.h"

namespace grainlaw::io {

/// Points of homogeneous shear as CSV, or as JSON columns. What a table does not say is an empty
/// field, or null.
std::string homogeneous_csv(const std::vector<continuum::HomogeneousState>& states);
std::string homogeneous_json(const std::vector<continuum::HomogeneousState>& states);

}  // namespace grainlaw::io
