#pragma once

#include <limits>
#include <optional>

#include "continuum/rheology.h"

namespace grainlaw::continuum {

/// Both closures at one pressure, as one curve in the mass coordinate:
///     tau(q) = tau_y + q (b + a q) / (1 + k q),   q = K |du/dM|,   k = kappa + 1/I_phi.
/// Generalised Bagnold: K = rho_p phi, so q = gd, and k = 0. Laws mu(I), phi(I): with
/// K = d sqrt(rho_p/p) rho_p phi_s, where phi_s is phi at I -> 0, the dilation phi = phi_s
/// (1 - I/I_phi) solves in closed form, I = q / (1 + q/I_phi), and a = 0, b = p f_p f_B beta. So
/// I < I_phi and phi > 0 hold for every q. Units d = rho_p = g = 1.
struct FlowCurve {
  double mobility = 1.0;      ///< K
  double yield_stress = 0.0;  ///< tau_y
  double linear = 0.0;        ///< b
  double quadratic = 0.0;     ///< a
  double kappa = 0.0;         ///< of mu(I)
  double I_phi = std::numeric_limits<double>::infinity();
  double static_volume_fraction = 0.0;  ///< phi_s

  double saturation() const { return kappa + 1.0 / I_phi; }
  /// tau - tau_y at q; odd in q.
  double viscous_stress(double q) const;
  double viscous_slope(double q) const;  ///< its derivative
  /// q at a driving stress tau: 0 up to the yield stress, absent where no q reaches tau.
  std::optional<double> scaled_rate(double tau) const;
  /// I / I_phi at the driving stress tau by the friction law alone; >= 1: no dense state. Absent
  /// where tau exceeds the largest friction.
  std::optional<double> relative_inertial_number(double tau) const;
  double volume_fraction(double q) const { return static_volume_fraction / (1.0 + q / I_phi); }
  double shear_rate(double q) const { return volume_fraction(q) * q / mobility; }
};

FlowCurve flow_curve(const GeneralisedBagnold& law, const GrainProperties& grains, double pressure);
FlowCurve flow_curve(const MuPhi& law, const GrainProperties& grains, double pressure);

/// (1 + Bo) p* and Bo in units d = rho_p = g = 1.
Confinement confinement(const GrainProperties& grains, double pressure);

}  // namespace grainlaw::continuum
