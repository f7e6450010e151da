#pragma once

#include "dem/coarse_graining.h"
#include "dem/packing.h"
#include "dem/simulation.h"
#include "dem/steady_state.h"

namespace grainlaw::dem {

/// Gravity in the frame of a base tilted by `inclination`: x down the slope, z away from the base.
Vec3 gravity(double strength, double inclination);

/// The engine's set-up for the scene, not yet tilted.
SimulationSetup chute_setup(const Scene& scene, const ChuteGrains& grains);

/// From under the deepest pocket of the base to well above the surface of the flow.
Bins chute_bins(const Scene& scene);

/// When the layer counts as arrested or as running away. A dense layer of depth h that obeys
/// Bagnold's profile has the mean velocity 2/5 I sqrt(phi g cos(theta)) h^1.5 / d; beyond I = 1
/// no dense flow is steady.
SteadyCriteria steady_criteria(const Scene& scene);

}  // namespace grainlaw::dem
