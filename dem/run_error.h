#pragma once

#include <stdexcept>

namespace grainlaw::dem {

/// A run that cannot go on: NaN, lost grain, overlap above max_overlap. Names grain, contact, step.
struct RunError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace grainlaw::dem
