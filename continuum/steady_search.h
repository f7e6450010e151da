#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "continuum/chute_1d.h"

namespace grainlaw::continuum {

/// What is known of a chute: of tilt, size (mass per area or depth) and mass flow any two.
struct ChuteQuestion {
  ChuteCase chute{};                      ///< the rest; its tilt and mass are those found
  std::optional<double> inclination{};    ///< [rad]
  std::optional<double> mass_per_area{};  ///< [mass/length^2]
  std::optional<double> depth{};          ///< of the free surface above the base plane [length]
  std::optional<double> mass_flow{};      ///< int rho u dz > 0, downhill [mass/(length time)]
};

/// The chute that answers a question, and its flow.
struct FoundChute {
  ChuteCase chute;  ///< with the tilt and the mass that were found
  SteadyChute steady;
  double mass_flow = 0.0;  ///< int rho u dz, downhill; 0 without flow [mass/(length time)]
};

/// No steady flow of the law meets the question; what() says why, in dimensionless numbers.
struct NoSuchFlow : std::runtime_error {
  enum class Missed { depth, mass_flow };
  NoSuchFlow(const std::string& why, Missed what, std::optional<double> reached = {})
      : std::runtime_error(why), missed(what), nearest(reached) {}

  Missed missed;
  std::optional<double> nearest;  ///< that a steady flow reaches; absent: nothing flows
};

/// Finds what is not given, by bracketing, to 1e-12 of the depth or flow asked for: depth and flow
/// grow with the mass at any tilt, the flow of a given mass grows with the tilt, and that of a
/// given depth does until the layer has thinned too much, up to where its root is looked for. With
/// tilt and size given the layer found may not flow; else throws NoSuchFlow. Throws
/// std::invalid_argument where the tilt is sought with a table that holds at its own tilt only, or
/// not exactly two of the three are given, and else like steady_chute.
FoundChute find_chute(const RheologyTable& table, const ChuteQuestion& question);

/// How far steady flow can be driven, over all tilts of a size or all depths at a tilt.
struct LargestFlow {
  FoundChute found;  ///< the largest flow inside the data, or of the law where that is less
  bool ended_by_data = false;  ///< I of `found` is the highest of the data
  /// Tilt [rad] or mass per area at which the steady flows of the law end.
  double law_limit = 0.0;
  Outcome law_end = Outcome::steady;  ///< beyond it; steady: side walls hold all that lies deeper
  std::optional<FoundChute> law;      ///< its largest flow; absent: without limit towards law_limit
};

/// Of tilt and size exactly one is given, and no flow. Throws NoSuchFlow where nothing flows, or
/// the flow of the law grows without limit and no data end it, and like find_chute.
LargestFlow largest_flow(const RheologyTable& table, const ChuteQuestion& question);

/// The flow of `largest_flow` where the data end it over all tilts, without asking how far the law
/// goes: what the propagation of errors repeats. Throws NoSuchFlow where I stays below the data's.
FoundChute end_of_data(const RheologyTable& table, const ChuteQuestion& question);

/// One standard error of each; 0 for what was given.
struct ChuteErrors {
  double inclination = 0.0;       ///< [rad]
  double mass_per_area = 0.0;     ///< [mass/length^2]
  double height = 0.0;            ///< of the free surface [length]
  double mass_flow = 0.0;         ///< [mass/(length time)]
  double surface_velocity = 0.0;  ///< with what was given held, unlike the band of a profile
};

/// Linear propagation of the table's covariance by finite differences through the whole search.
/// Absent where the table states no errors or a step of a coefficient leaves what can be answered.
std::optional<ChuteErrors> search_errors(
    const RheologyTable& table, const std::function<FoundChute(const RheologyTable&)>& find);

}  // namespace grainlaw::continuum
