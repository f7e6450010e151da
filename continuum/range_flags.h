#pragma once

#include <vector>

#include "continuum/layer.h"

namespace grainlaw::continuum {

/// Flags of a profile in units d = rho_p = g = 1, resolved to the mass between its rows. An empty
/// profile (no flow) can still have the wrong inclination.
std::vector<RangeFlag> range_flags(const Layer& layer,
                                   const RheologyTable& table,
                                   const Profile& profile);

}  // namespace grainlaw::continuum
