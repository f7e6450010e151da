#pragma once

#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/contact.h"

namespace grainlaw::dem {

/// The normal force that bounds friction, mu |reference|.
enum class CoulombReference {
  total,      ///< |F_n|, cohesion included (Brewster et al. 2008, text below eq. 3)
  repulsive,  ///< the contact force without cohesion, 0 where that pulls (Shi et al. 2020)
};

template <class S>
S coulomb_reference(CoulombReference reference, const S& contact_force, const S& cohesive_force) {
  return reference == CoulombReference::total ? abs(contact_force + cohesive_force)
                                              : max(contact_force, S(0.0));
}

/// exp(-y), y >= 0: the series at y/64 and six squarings, the same for numbers and packs, whose own
/// exp is one call per pair. Relative error 1e-13 for y < 16, absolute 1e-16 beyond.
template <class S>
[[gnu::always_inline]] inline S exp_minus(const S& y) {
  const S z = min(y, S(36.0)) * (1.0 / 64.0);
  S sum = S(1.0);
  for (int k = 11; k > 0; --k) sum = 1.0 - (1.0 / k) * z * sum;
  for (int k = 0; k < 6; ++k) sum = sum * sum;
  return sum;
}

/// No attraction: no force, no range beyond contact, nothing stored.
struct Cohesionless {
  static constexpr std::string_view name = "none";
  static constexpr bool attracts = false;
  static constexpr bool bridges = false;
};

/// A narrow well at contact, F = 2 A (overlap - l) / l^2 exp(-(overlap - l)^2 / l^2), zero beyond
/// the gap 2 l  (Brewster et al. 2008, eqs. 4 and 5 with r_c = d - l; l = 0.01 d there, cut at
/// 1.02 d). It attracts where overlap < l and pushes inside.
struct GaussianWell {
  static constexpr std::string_view name = "gaussian_well";
  static constexpr bool attracts = true;
  static constexpr bool bridges = false;
  double strength = 0.0;  ///< A [energy]
  double width = 0.0;     ///< l [length]
  CoulombReference reference = CoulombReference::total;

  template <class S>
  [[gnu::always_inline]] S force(const ContactOf<S>& c, const Mask<S>&) const {
    const S x = (c.overlap - width) / width;
    return select(c.overlap > -range(), 2.0 * strength / width * x * exp_minus(x * x), S(0.0));
  }
  /// Zero at the cut [energy].
  double energy(const Contact& c, bool) const {
    const double x = (c.overlap - width) / width;
    if (c.overlap <= -range()) return 0.0;
    return -strength * (std::exp(-x * x) - std::exp(-9.0));
  }
  double range() const { return 2.0 * width; }
  /// sqrt(2/e) A/l [force].
  double largest_attraction(double /*harmonic_radius*/) const {
    return std::sqrt(2.0 / std::numbers::e) * strength / width;
  }
  double steepest_slope(double /*harmonic_radius*/) const {
    return 2.0 * strength / (width * width);
  }
  /// The distance beyond contact at which a pair still carries the weight of a grain, eq. 12 of
  /// Brewster et al. (with its sign corrected); 0 where the well is too weak for it [length].
  double effective_range(double weight) const;
};

/// Dry, reversible: constant attraction in contact, falling linearly with the gap
/// (Shi et al. 2020, eq. 3).
struct ReversibleAdhesion {
  static constexpr std::string_view name = "reversible_adhesion";
  static constexpr bool attracts = true;
  static constexpr bool bridges = false;
  double largest_force = 0.0;  ///< f_a,max [force]
  double slope = 0.0;          ///< k_ca [force/length]
  CoulombReference reference = CoulombReference::repulsive;

  template <class S>
  [[gnu::always_inline]] S force(const ContactOf<S>& c, const Mask<S>&) const {
    return -max(min(largest_force + slope * c.overlap, S(largest_force)), S(0.0));
  }
  /// Zero out of range [energy].
  double energy(const Contact& c, bool) const {
    const double inside = std::max(0.0, std::min(c.overlap, 0.0) + range());
    return -0.5 * slope * inside * inside - largest_force * std::max(c.overlap, 0.0);
  }
  double range() const { return largest_force / slope; }
  double largest_attraction(double /*harmonic_radius*/) const { return largest_force; }
  double steepest_slope(double /*harmonic_radius*/) const { return slope; }
};

/// Wet: a liquid bridge that forms at the first touch and ruptures at the gap S_c
/// (Shi et al. 2020, eq. 4; the fit of Willett et al. 2000):
/// f_a = -f_max in contact, -f_max / (1 + 1.05 S' + 2.5 S'^2) at the gap S, S' = S sqrt(r/V),
/// f_max = 2 pi r gamma_s cos(theta), r = 2 R_i R_j / (R_i + R_j), S_c = (1 + theta/2) V^(1/3).
struct LiquidBridge {
  static constexpr std::string_view name = "liquid_bridge";
  static constexpr bool attracts = true;
  static constexpr bool bridges = true;
  static constexpr double linear_term = 1.05;  // Willett et al., as in Shi et al. eq. 4
  static constexpr double quadratic_term = 2.5;
  double surface_tension = 0.0;  ///< gamma_s [force/length]
  double contact_angle = 0.0;    ///< theta [rad]
  double volume = 0.0;           ///< V of one bridge [length^3]
  CoulombReference reference = CoulombReference::repulsive;

  template <class S>
  [[gnu::always_inline]] S force(const ContactOf<S>& c, const Mask<S>& bridged) const {
    const S gap = max(-c.overlap, S(0.0)) * sqrt(c.harmonic_radius / volume);
    const S pull = attraction_per_radius() * c.harmonic_radius /
                   (1.0 + gap * (linear_term + quadratic_term * gap));
    return select(bridged, -pull, S(0.0));
  }
  /// Of a bridge, zero at first touch; what it holds at rupture is lost [energy].
  double energy(const Contact& c, bool bridged) const {
    if (!bridged) return 0.0;
    if (c.overlap >= 0.0) return -largest_attraction(c.harmonic_radius) * c.overlap;
    const double unit = std::sqrt(volume / c.harmonic_radius);  // [length]
    return largest_attraction(c.harmonic_radius) * unit * work(-c.overlap / unit);
  }
  double rupture_energy(double harmonic_radius) const {
    Contact contact;
    contact.overlap = -range();
    contact.harmonic_radius = harmonic_radius;
    return energy(contact, true);
  }
  double range() const { return (1.0 + 0.5 * contact_angle) * std::cbrt(volume); }
  double largest_attraction(double harmonic_radius) const {
    return attraction_per_radius() * harmonic_radius;
  }
  double steepest_slope(double harmonic_radius) const {
    return largest_attraction(harmonic_radius) * linear_term * std::sqrt(harmonic_radius / volume);
  }

 private:
  double attraction_per_radius() const {
    return 2.0 * std::numbers::pi * surface_tension * std::cos(contact_angle);
  }
  /// Integral of 1 / (1 + 1.05 s + 2.5 s^2) from 0 to s.
  static double work(double s) {
    const double root = std::sqrt(4.0 * quadratic_term - linear_term * linear_term);
    const auto primitive = [&](double at) {
      return 2.0 / root * std::atan((2.0 * quadratic_term * at + linear_term) / root);
    };
    return primitive(s) - primitive(0.0);
  }
};

inline double GaussianWell::effective_range(double weight) const {
  const double gap_of_largest = -width * (1.0 - 1.0 / std::numbers::sqrt2);
  const auto pull = [&](double gap) {
    Contact contact;
    contact.overlap = -gap;
    return -force(contact, true);
  };
  if (pull(gap_of_largest) <= weight) return 0.0;
  double low = gap_of_largest;
  double high = range() * (1.0 - 1e-12);
  if (pull(high) > weight) return range();
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (pull(middle) > weight ? low : high) = middle;
  }
  return std::max(0.0, low);
}

}  // namespace grainlaw::dem
