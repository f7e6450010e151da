#pragma once

#include <string>

#include "apps/io/units.h"
#include "continuum/split_bottom.h"

namespace grainlaw::io {

/// Centre of the band of a split-bottom cell, bottom to top, in the given units: as CSV with the
/// unit of every column in its header and the answer in comment lines before it, or as JSON.
std::string split_bottom_csv(const continuum::SplitBottom& cell, const Units& units);
std::string split_bottom_json(const continuum::SplitBottom& cell, const Units& units);

}  // namespace grainlaw::io
