#pragma once

#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// Tilts of a chute [degrees]: it flows in +x.
inline constexpr Bounds chute_tilts{.lower = 0.0, .upper = 90.0, .lower_allowed = true};

/// Reads the kind of the flow, a word of [geometry].
std::string read_kind(Section& geometry);

/// Reads the units of a scene, with the gravity of flows that fall.
Units read_scene_units(InputFile& in, Section& geometry, const std::string& kind);

/// Reads [geometry] and its subsections. With a start, where the grains come from a file, keys that
/// make a packing are refused, and the number of grains is 0.
dem::Geometry read_geometry(InputFile& in,
                            Section& geometry,
                            const std::string& kind,
                            const Units& units,
                            const dem::Grains& grains,
                            bool with_start);

}  // namespace grainlaw::io
