#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>

#include "continuum/rheology.h"

namespace grainlaw::continuum {

/// Both closures at one pressure, as one curve in the mass coordinate:
///     tau(q) = tau_y + q (b + a q) / (1 + k q),   q = K |du/dM|,   k = kappa + 1/I_phi.
/// Generalised Bagnold: K = rho_p phi, so q = gd, and k = 0. Laws mu(I), phi(I): with
/// K = d sqrt(rho_p/p) rho_p phi_s, where phi_s is phi at I -> 0, the dilation phi = phi_s
/// (1 - I/I_phi) solves in closed form, I = q / (1 + q/I_phi), and a = 0, b = p f_p f_B beta. So
/// I < I_phi and phi > 0 hold for every q. A law in x = I^n with n other than 1 has the viscous
/// part b x / (1 + kappa x) instead, and a tabulated one x = mu(I) - mu(0), b = p f_p f_B and kappa
/// = 0. Units d = rho_p = g = 1.
struct FlowCurve {
  double mobility = 1.0;                     ///< K
  double yield_stress = 0.0;                 ///< tau_y
  double linear = 0.0;                       ///< b
  double quadratic = 0.0;                    ///< a
  double kappa = 0.0;                        ///< of mu(I)
  double exponent = 1.0;                     ///< n
  const MonotoneCurve* tabulated = nullptr;  ///< mu(I) of the law, which has to outlive this
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
  double volume_fraction(double q) const {
    return static_volume_fraction / (1.0 + std::abs(q) / I_phi);
  }
  double shear_rate(double q) const { return volume_fraction(q) * q / mobility; }
  /// No I carries more; infinite where stress rises without limit.
  double largest_stress() const;

 private:
  bool rational() const { return exponent == 1.0 && !tabulated; }
  double variable(double I) const;  ///< x
  double variable_slope(double I) const;
  std::optional<double> inertial_number(double tau) const;
};

FlowCurve flow_curve(const GeneralisedBagnold& law, const GrainProperties& grains, double pressure);
FlowCurve flow_curve(const MuPhi& law, const GrainProperties& grains, double pressure);

/// What grains under a given shear stress and pressure do in steady flow.
enum class LocalState {
  rests,           ///< the yield stress holds them
  flows,           ///< at one shear rate
  no_steady,       ///< the stress exceeds the largest friction
  no_dense_state,  ///< only at I beyond I_phi, where phi would vanish
  no_friction,     ///< softness takes all friction, f_p <= 0: the law has left physics
};

std::string_view name(LocalState state);  ///< "rests", "flows", ...

/// The inverse of the law in d = rho_p = g = 1: what happens under tau >= 0, and how fast.
struct LocalFlow {
  LocalState state = LocalState::rests;
  double shear_rate = 0.0;
  double inertial_number = 0.0;  ///< also where it is beyond I_phi; 0 where none exists
  double volume_fraction = 0.0;  ///< 0 where there is no state
};
LocalFlow local_flow(const GeneralisedBagnold& law,
                     const GrainProperties& grains,
                     double tau,
                     double pressure);
LocalFlow local_flow(const MuPhi& law, const GrainProperties& grains, double tau, double pressure);

/// tau(gd, p) and its derivatives, exact; gd > 0, p > 0, in one consistent set of units.
struct StressResponse {
  double stress = 0.0;
  double by_shear_rate = 0.0;  ///< not positive: no steady flow of this law is stable
  double by_pressure = 0.0;
};
StressResponse stress_response(const GeneralisedBagnold& law,
                               const GrainProperties& grains,
                               double shear_rate,
                               double pressure);
StressResponse stress_response(const MuPhi& law,
                               const GrainProperties& grains,
                               double shear_rate,
                               double pressure);

}  // namespace grainlaw::continuum
