#pragma once

#include <functional>
#include <optional>
#include <string>

#include "apps/io/units.h"
#include "apps/summary.h"
#include "continuum/profile.h"
#include "continuum/rheology_table.h"

namespace grainlaw {

/// A flow whose grains can be exchanged, in internal units.
struct FlowOfGrains {
  const continuum::Profile& profile;
  continuum::GrainProperties grains;
  std::string place;     ///< of the first row of the profile: "at the base"
  std::string response;  ///< what other grains would change: "surface velocity"
  double value;          ///< of the response
  io::Dimension dimension;
  /// The response with other grains, all else the same; absent where nothing flows.
  std::function<std::optional<double>(const continuum::GrainProperties&)> with;
};

/// Where grains attract each other and the friction of the table has no term for that: a sentence.
std::optional<std::string> unknown_cohesion(const continuum::RheologyTable& table,
                                            bool grains_attract);
void say_unknown_cohesion(Summary& summary,
                          const continuum::RheologyTable& table,
                          bool grains_attract);

/// p* and Bo of the flow, how much rigid grains would differ, and which stiffness and time step a
/// DEM of these grains needs; nothing that the case does not give.
void say_grain_scales(Summary& summary,
                      const FlowOfGrains& flow,
                      const continuum::RheologyTable& table,
                      const io::Units& units);

}  // namespace grainlaw
