#pragma once

#include "continuum/rheology.h"

namespace grainlaw::continuum {

/// Velocity at `depth` below the free surface of a layer of uniform density on an incline, with
/// u = 0 at `base_depth`; `c` = rho g sin(theta) is the shear stress gained per unit depth.
///
/// Brewster et al. 2008, eq. 9, which integrates the generalised Bagnold law through the depth, in
/// a form without cancellation: with g0, g1 the shear rates at the base and at the depth, u is
/// (base_depth - depth) times
///     [3/2 b (g0 + g1) + 2 a (g0^2 + g0 g1 + g1^2)] / (3 [b + a (g0 + g1)]).
/// The printed form loses 8e-12, 6e-8, 3e-3 of the result at a = 1e-4, 1e-6, 1e-8 (b = 0.8). The
/// layer above depth tau_c / c moves as a plug.
template <class S, class T>
S bagnold_velocity(
    const S& a, const S& b, const S& tau_c, double c, const T& base_depth, double depth) {
  const S plug_depth = tau_c / c;
  if (!(base_depth > plug_depth)) return S(0.0);
  const S sheared_depth = plug_depth > depth ? plug_depth : S(depth);
  const S g0 = bagnold_shear_rate(a, b, c * (base_depth - plug_depth));
  const S g1 = bagnold_shear_rate(a, b, c * (sheared_depth - plug_depth));
  return (base_depth - sheared_depth) *
         (1.5 * b * (g0 + g1) + 2.0 * a * (g0 * g0 + g0 * g1 + g1 * g1)) /
         (3.0 * (b + a * (g0 + g1)));
}

}  // namespace grainlaw::continuum
