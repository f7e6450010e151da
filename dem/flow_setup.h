#pragma once

#include <optional>
#include <vector>

#include "dem/coarse_graining.h"
#include "dem/ring_sampler.h"
#include "dem/scene.h"
#include "dem/simulation.h"
#include "dem/steady_state.h"

namespace grainlaw::dem {

/// Gravity in the frame of a base tilted by `inclination`: x down the slope, z away from the base.
Vec3 gravity(double strength, double inclination);

/// The engine's set-up for the flow of a scene.
SimulationSetup flow_setup(const Scene& scene, const InitialState& initial);

/// The same before the flow, in which a packing comes to rest: a chute not tilted, walls and rings
/// not moving. Absent where there is nothing to settle.
std::optional<SimulationSetup> settling_setup(const Scene& scene, const InitialState& initial);

/// A field that acts from a step on.
struct FieldChange {
  long step = 0;  ///< the first one it acts in, counted from 0
  Uniform field;
};

/// Tilts of a chute that follow the first: gravity turns before the first step that does not begin
/// earlier. Empty for other flows.
std::vector<FieldChange> field_changes(const Scene& scene);

/// Bins are finer than the rows of fields, at least four to the width of the kernel.
std::size_t bins_per_row(const Measurement& measurement);

/// How profiles are taken, for the box as it is now.
Bins profile_bins(const Scene& scene, const Box& box);

/// Of a ring cell, the same over height too.
std::optional<RingBins> ring_bins(const Scene& scene);

/// When a chute counts as arrested or as running away. A dense layer of depth h that obeys
/// Bagnold's profile has the mean velocity 2/5 I sqrt(phi g cos(theta)) h^1.5 / d; beyond I = 1
/// no dense flow is steady. Flows that are driven do neither.
SteadyCriteria steady_criteria(const Scene& scene);

/// What a run counts its settling and progress by [time]: sqrt(d/g), 1/shear rate, d over the
/// velocity of a wall, or d sqrt(rho_p/p).
double unit_time(const Scene& scene);

}  // namespace grainlaw::dem
