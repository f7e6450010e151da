#pragma once

#include <optional>
#include <string>

#include "apps/io/input_file.h"

namespace grainlaw::io {

/// Exponents of mass, length and time.
struct Dimension {
  int mass = 0;
  int length = 0;
  int time = 0;

  friend bool operator==(const Dimension&, const Dimension&) = default;
};

namespace dimension {
inline constexpr Dimension number{};
inline constexpr Dimension length{0, 1, 0};
inline constexpr Dimension time{0, 0, 1};
inline constexpr Dimension rate{0, 0, -1};
inline constexpr Dimension velocity{0, 1, -1};
inline constexpr Dimension flux{0, 2, -1};
inline constexpr Dimension temperature{0, 2, -2};
inline constexpr Dimension acceleration{0, 1, -2};
inline constexpr Dimension force{1, 1, -2};
inline constexpr Dimension stiffness{1, 0, -2};
inline constexpr Dimension tension{1, 0, -2};  ///< force/length
inline constexpr Dimension energy{1, 2, -2};
inline constexpr Dimension volume{0, 3, 0};
inline constexpr Dimension dashpot{1, 0, -1};
inline constexpr Dimension density{1, -3, 0};
inline constexpr Dimension mass_per_area{1, -2, 0};
inline constexpr Dimension mass_flow{1, -1, -1};  ///< per unit width
inline constexpr Dimension stress{1, -1, -2};
inline constexpr Dimension bagnold_a{1, -1, 0};   ///< mass/length
inline constexpr Dimension bagnold_b{1, -1, -1};  ///< mass/(length time)
}  // namespace dimension

/// One internal unit (grain mass m, mean diameter d, sqrt(d/g)) in the units of a file.
/// Named sets: "grain" (m, d, g = 1), "stiffness" (rho_p, d, k_n = 1), "si" (kg, m, s).
struct Units {
  std::string name = "grain";
  double length = 1.0;
  double mass = 1.0;
  double time = 1.0;

  double size(Dimension dimension) const;         ///< of one internal unit, in the file's units
  Unit operator[](Dimension dimension) const;     ///< for a key: "mass/time^2" and the size
  std::string symbol(Dimension dimension) const;  ///< "m/s" or "sqrt(g d)"; "1" for a number
  std::string symbols() const;  ///< what the letters of symbol() stand for, a sentence
};

/// The internal units themselves.
inline Units grain_units() {
  return {};
}

/// Units of a set, for the diameter, density and gravity of a file in that set.
Units stiffness_units(double gravity);
Units si_units(double diameter, double density, double gravity);

/// Reads `units`, [grains] and the key `gravity` of a section, and refuses keys that the named set
/// already fixes (a diameter in units of diameters).
Units read_units(InputFile& in, Section& with_gravity);

/// The same where nothing falls: the unit of time of the file is kept, and in SI 9.81 m/s^2 takes
/// the place of g in the internal one.
Units read_units(InputFile& in);

/// The key `stiffness`, which the set "stiffness" fixes, in internal units.
std::optional<double> find_stiffness(Section& section, const Units& units);
double read_stiffness(Section& section, const Units& units);

/// Degrees to radians.
double radians(double degrees);
double degrees(double radians);

/// Degrees that give exactly this tilt when they are read, with as few digits as possible; not
/// every number of radians has some.
std::optional<double> exact_degrees(double tilt);

}  // namespace grainlaw::io
