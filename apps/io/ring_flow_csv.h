#pragma once

#include <string>

#include "apps/io/units.h"
#include "continuum/ring_flow.h"

namespace grainlaw::io {

/// Rotation of a ring cell over its cross-section, in the given units. CSV: a line per node, bottom
/// to top and from the inner to the outer cylinder, its columns z, r, omega / Omega and velocity;
/// the answer in comment lines before. JSON: the same as a field, and the band at every height.
std::string ring_flow_csv(const continuum::RingFlow& flow,
                          double rotation_rate,
                          const Units& units);
std::string ring_flow_json(const continuum::RingFlow& flow, const Units& units);

}  // namespace grainlaw::io
