#pragma once

#include "continuum/chute_1d.h"
#include "continuum/layer.h"

namespace grainlaw::continuum {

/// Steady profile of a layer whose verdict is steady or plug, in units d = rho_p = g = 1; rows at
/// equal steps of mass from the base to the surface.
Profile steady_profile(const Layer& layer, double plug_mass, const SteadyOptions& options);

}  // namespace grainlaw::continuum
