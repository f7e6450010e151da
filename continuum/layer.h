#pragma once

#include <string>
#include <variant>

#include "continuum/answer.h"
#include "continuum/chute_1d.h"
#include "continuum/flow_curve.h"

namespace grainlaw::continuum {

/// Units of a chute: every computation runs in d = rho_p = g = 1 and is converted once on the way
/// in and once on the way out.
struct Units {
  double length;         ///< d
  double time;           ///< sqrt(d / g)
  double mass_per_area;  ///< rho_p d
  double gravity;        ///< g

  double velocity() const { return length / time; }
  double stress() const { return mass_per_area * gravity; }
};

/// A chute in units d = rho_p = g = 1, tilted to positive angles, cut at the effective base.
struct Layer {
  std::variant<GeneralisedBagnold, MuPhi> law;
  GrainProperties grains;
  Units units{};
  double direction = 1.0;    ///< -1: tilted to negative angles, flows to negative x
  double inclination = 0.0;  ///< |theta| [rad]
  double sine = 0.0;
  double cosine = 1.0;
  double mass = 0.0;         ///< M1 above the effective base
  double base_height = 0.0;  ///< z of u = 0
  double slip_length = 0.0;
  double wall_drag = 0.0;  ///< 2 mu_w K / W of side walls; 0: none

  double pressure(double mass_above) const { return cosine * mass_above; }
  double driving_stress(double mass_above) const { return sine * mass_above; }
  /// Deceleration that side walls exert on all that moves.
  double wall_deceleration(double mass_above, double volume_fraction) const {
    return wall_drag * pressure(mass_above) / volume_fraction;
  }
  FlowCurve curve(double mass_above) const;
  /// Mass at which quantities with a limit at the free surface are evaluated instead of at 0.
  double surface_mass() const { return 1e-30 * mass; }
};

/// Throws std::invalid_argument for a case without meaning. Does not validate the table.
Layer make_layer(const RheologyTable& table, const ChuteCase& chute);

/// What the steady balance tau = g sin(theta) M says before any profile is computed. The sheared
/// part lies below one plug edge, as no law lets the yield friction tau_y / p rise with depth.
struct Verdict {
  Outcome outcome = Outcome::steady;
  std::string text{};
  double plug_mass = 0.0;
  double condition_number = 0.0;
};

Verdict steady_verdict(const Layer& layer);

/// d ln I / d ln mu of mu(I) at the base under the stress tau there; of the law in I itself (1 +
/// kappa I) tau / (tau - tau_y). 0 without shear and for laws other than mu(I).
double condition_number(const Layer& layer, double tau);

/// Softness takes all friction at the base, f_p <= 0: the law has left physics.
bool no_friction_left(const Layer& layer);

/// Profile in the units and the direction of the case.
Profile in_case_units(const Layer& layer, Profile profile);

}  // namespace grainlaw::continuum
