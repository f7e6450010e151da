#pragma once

#include "apps/io/units.h"
#include "dem/scene.h"

namespace grainlaw::io {

/// Reads [contact.normal], [contact.cohesion] and [contact.friction]; a missing one of the latter
/// two is a missing mechanism.
void read_laws(InputFile& in, const Units& units, dem::Scene& scene);

}  // namespace grainlaw::io
