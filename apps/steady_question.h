#pragma once

#include <optional>

#include "continuum/chute_1d.h"

namespace grainlaw {

/// The steady flow of a chute with its error band. Where the depth is given, that of the free
/// surface above the base [d], the mass per area of the chute is found and set. Throws NoAnswer
/// where no mass gives a flow of that depth.
continuum::SteadyChute steady_with_band(const continuum::RheologyTable& table,
                                        continuum::ChuteCase& chute,
                                        const std::optional<double>& depth);

}  // namespace grainlaw
