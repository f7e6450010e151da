#pragma once

#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// Tilts of a chute [degrees]: it flows in +x.
inline constexpr Bounds chute_tilts{.lower = 0.0, .upper = 90.0, .lower_allowed = true};

/// What a scene flows in, and the units of its file: they hang on gravity, where grains fall.
struct Flow {
  dem::Geometry geometry;
  Units units;
};

/// Reads [geometry], its subsections and the units. With a start, where the grains come from a
/// file, keys that make a packing are refused, and the number of grains is 0.
Flow read_flow(InputFile& in, const dem::Grains& grains, bool with_start);

}  // namespace grainlaw::io
