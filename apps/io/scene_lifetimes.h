#pragma once

#include <optional>

#include "apps/io/input_file.h"
#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// The section [lifetimes] of a scene file; absent: contacts are not followed.
std::optional<dem::Lifetimes> read_lifetime_keys(InputFile& in, const Units& units);

}  // namespace grainlaw::io
