#pragma once

#include <cmath>

namespace grainlaw::dem {

/// What the time scales of a place in a flow follow from. Any consistent units.
struct FlowPoint {
  double grain_density = 0.0;  ///< rho_p [mass/length^3]
  double diameter = 0.0;       ///< d, the number mean [length]
  double stiffness = 0.0;      ///< k_n [mass/time^2]
  double attraction = 0.0;     ///< f_a, the largest of a pair of mean grains [force]
  double gravity = 0.0;        ///< g [length/time^2]
  double shear_rate = 0.0;     ///< [1/time]
  double pressure = 0.0;       ///< p [stress]
  double temperature = 0.0;    ///< T, mean square velocity fluctuation per component
                               ///< [(length/time)^2]
};

/// Time scales (Shi et al. 2020, eqs. 5-9) [time]; infinite where the mechanism is absent.
struct TimeScales {
  double contact = 0.0;      ///< t_k = sqrt(rho_p d^3 / k_n), eq. 5
  double cohesion = 0.0;     ///< t_c = sqrt(rho_p d^4 / f_a), eq. 6
  double shear = 0.0;        ///< t_gd = 1 / shear rate, eq. 7
  double pressure = 0.0;     ///< t_p = d sqrt(rho_p / p), eq. 8
  double temperature = 0.0;  ///< t_T = d / sqrt(T), eq. 9
  double gravity = 0.0;      ///< t_g = sqrt(d / g), in words in section 2.3
};

inline TimeScales time_scales(const FlowPoint& at) {
  const double d = at.diameter;
  return {.contact = std::sqrt(at.grain_density * d * d * d / at.stiffness),
          .cohesion = std::sqrt(at.grain_density * d * d * d * d / at.attraction),
          .shear = 1.0 / at.shear_rate,
          .pressure = d * std::sqrt(at.grain_density / at.pressure),
          .temperature = d / std::sqrt(at.temperature),
          .gravity = std::sqrt(d / at.gravity)};
}

/// Ratios of time scales to that of pressure, by which a state of dense flow is named.
struct DimensionlessNumbers {
  double inertial_number = 0.0;  ///< I = t_p / t_gd, eq. 10
  double softness = 0.0;         ///< p* = (t_k / t_p)^2 = p d / k_n, eq. 11
  double bond_number = 0.0;      ///< Bo = (t_p / t_c)^2 = f_a / (p d^2), eq. 12
  double temperature = 0.0;      ///< T* = (t_p / t_T)^2 = rho_p T / p
};

inline DimensionlessNumbers dimensionless_numbers(const TimeScales& t) {
  const auto square = [](double x) { return x * x; };
  return {.inertial_number = t.pressure / t.shear,
          .softness = square(t.contact / t.pressure),
          .bond_number = square(t.pressure / t.cohesion),
          .temperature = square(t.pressure / t.temperature)};
}

/// The inertial numbers in use: with the shear rate or the strain rate (half of it), with the
/// density of the grains or of the bulk (Shi et al. 2020, text below eq. 10).
enum class InertialNumber { shear_grain, shear_bulk, strain_grain, strain_bulk };

/// The factor by which I of Shi et al. (shear_grain) is multiplied to give another one.
inline double conversion(InertialNumber to, double volume_fraction) {
  const bool bulk = to == InertialNumber::shear_bulk || to == InertialNumber::strain_bulk;
  const bool strain = to == InertialNumber::strain_grain || to == InertialNumber::strain_bulk;
  return (bulk ? std::sqrt(volume_fraction) : 1.0) * (strain ? 0.5 : 1.0);
}

/// An inertial number, or a constant of that dimension such as I_phi, in another definition.
inline double converted(double value,
                        InertialNumber from,
                        InertialNumber to,
                        double volume_fraction) {
  return value * conversion(to, volume_fraction) / conversion(from, volume_fraction);
}

}  // namespace grainlaw::dem
