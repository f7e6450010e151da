#pragma once

#include <cstdint>
#include <vector>

#include "dem/initial_state.h"
#include "dem/random_packing.h"
#include "dem/scene.h"

namespace grainlaw::dem {

/// Diameters of `count` grains: the middle of every `count`-th part of the size distribution, in
/// random order. Their mean is that of the grains exactly, their mean cube up to a relative error
/// below 1/count^2 [length].
std::vector<double> diameters(const Grains& grains, std::size_t count, std::uint64_t seed);

/// Where the grains of a scene start: the given start, or a random packing made for the geometry in
/// which no mobile grain overlaps another (to rounding), mobile grains first.
/// Equal scenes give equal states. Throws SceneError when a packing is too dense to come apart, and
/// PackingStopped.
///
/// Chute: base below z = 0; the grains above it at nominal_packing with an open top, all at rest.
///   Sidewalls, if any, at y = 0 and y = width.
/// SimpleShear: v_x = shear_rate (y - L_y/2), so that the momentum is near 0.
/// PlaneShear: lower wall as the base of a chute; the lowest centre of the upper wall is at
///   z = gap + d/2, gap = N V / (phi A); v_x = velocity z / gap between the walls.
/// BodyForceBox: periods length, N V / (phi A) and width in x, y, z; at rest.
/// SplitBottom: sector 0 <= angle < wedge about z, surfaces of grains between the cylinders (glued
///   ones too); base and column as in a chute, packed with their rotational images.
///
/// A given start is taken as it is, in its order, positions wrapped into the periods. Its frozen
/// grains are the base; those of a PlaneShear above the middle of all grains, and those of a
/// SplitBottom outside the split radius, are the mover.
InitialState initial_state(const Scene& scene, const KeepGoing& keep_going = {});

/// The state with its free grains moving as the profile says, linear between its points and
/// constant beyond them, and spinning with half the shear rate, as grains of a steady flow do in
/// the mean.
InitialState moving(InitialState state, const std::vector<StartVelocity>& profile);

}  // namespace grainlaw::dem
