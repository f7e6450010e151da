#pragma once

#include <optional>

#include "apps/io/case_input.h"
#include "apps/summary.h"
#include "continuum/steady_search.h"

namespace grainlaw {

/// The steady flow of a chute with its error band. Where the depth is given, that of the free
/// surface above the base [d], the mass per area of the chute is found and set. Throws NoAnswer
/// where no mass gives a flow of that depth.
continuum::SteadyChute steady_with_band(const continuum::RheologyTable& table,
                                        continuum::ChuteCase& chute,
                                        const std::optional<double>& depth);

/// What is known of the steady flow a case asks for.
struct SteadyAnswer {
  continuum::SteadyChute steady;  ///< with its error band
  double mass_flow = 0.0;
  std::optional<continuum::ChuteErrors> errors;   ///< of what was found
  std::optional<continuum::LargestFlow> largest;  ///< answer = "largest_flow"
};

/// Finds what the case does not give of tilt, size and mass flow, or the largest flow, and sets
/// tilt and mass of its chute. Throws NoAnswer, in the units of the file.
SteadyAnswer answer_steady(const continuum::RheologyTable& table, io::CaseFile& file);

/// Outcome, the three of which two were given, and the speed; of a largest flow what ends it.
void describe(Summary& summary, const SteadyAnswer& answer, const io::CaseFile& file);

/// Whether the layer is deep enough for a local law; nothing where that cannot be said.
void describe_depth(Summary& summary,
                    const continuum::RheologyTable& table,
                    const continuum::Profile& profile,
                    const io::CaseFile& file);

}  // namespace grainlaw
