#pragma once

#include <span>
#include <vector>

#include "dem/initial_state.h"
#include "dem/packing_region.h"

namespace grainlaw::dem {

/// Grains that close every hole of a glued layer through which a grain of this diameter could fall,
/// as if one had fallen in and stuck: their centres lie at the height of the lowest one of the
/// layer, so that its surface stays as it is. Most layers have no hole and get none. The layer
/// covers x, y (radius, angle) of the ground; its grains lie inside the periods.
/// A passage may count as a hole when it is narrower than the grain by up to 7 %: soft grains are
/// squeezed through. Grains well below the mean of a wide size distribution find ways of their own,
/// which stay open.
std::vector<InitialGrain> hole_plugs(const Region& ground,
                                     std::span<const InitialGrain> layer,
                                     double diameter);

}  // namespace grainlaw::dem
