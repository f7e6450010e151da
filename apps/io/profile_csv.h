#pragma once

#include <string>

#include "apps/io/units.h"
#include "continuum/answer.h"
#include "continuum/profile.h"

namespace grainlaw::io {

/// What left the range of the data, and how far.
std::string flag_text(const continuum::RangeFlag& flag);

/// A profile in the given units, as CSV with the unit of every column in its header and the answer
/// in comment lines before it. Errors are there when the table states any. `coordinate` is what z
/// of the rows is called, "r" between cylinders.
std::string profile_csv(const continuum::Profile& profile,
                        const continuum::Answer& answer,
                        const Units& units,
                        const std::string& coordinate = "z");

/// Same as JSON.
std::string profile_json(const continuum::Profile& profile,
                         const continuum::Answer& answer,
                         const Units& units,
                         const std::string& coordinate = "z");

}  // namespace grainlaw::io
