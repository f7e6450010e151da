#pragma once

#include <span>
#include <vector>

#include "continuum/layer.h"

namespace grainlaw::continuum {

/// Steady balance between side walls, dtau/dM = sin(theta) - c p / phi(tau, p), c = 2 mu_w K / W,
/// integrated from the free surface down in s = sqrt(M) (classical Runge-Kutta, ends of the sheared
/// part found by bisection). tau / p falls with depth, so the sheared part lies below a plug, if
/// the grains are cohesive, and above a part that the walls hold at rest, if the layer is deep.
struct WalledPoint {
  double mass = 0.0;
  double stress = 0.0;
  double shear = 0.0;   ///< int |du/dM| dM from the surface to here
  double height = 0.0;  ///< int dM / phi
  double flux = 0.0;    ///< int M |du/dM| dM
};

struct WalledFlow {
  std::vector<WalledPoint> points;       ///< at the masses asked for
  double plug_mass = 0.0;                ///< all of the layer where nothing shears
  double sheared_mass = 0.0;             ///< mass above the lower end of the sheared part
  LocalState worst = LocalState::rests;  ///< flows, or why there is no steady flow
  double worst_mass = 0.0;               ///< where
};

/// `masses` ascending, from 0 to that of the layer. The march ends where the law has no steady
/// flow, judged at the stress times 1 + margin.
WalledFlow walled_flow(const Layer& layer, std::span<const double> masses, double margin = 0.0);

/// Steady profile of a layer whose verdict is steady or plug.
Profile walled_profile(const Layer& layer, int rows);

Verdict walled_verdict(const Layer& layer);

}  // namespace grainlaw::continuum
