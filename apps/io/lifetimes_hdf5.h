#pragma once

#include "apps/io/hdf5_file.h"
#include "dem/lifetime_statistics.h"

namespace grainlaw::io {

/// The group /lifetimes of a local data file, a group 0, 1, ... in it for every d_c.
void write_lifetimes(Hdf5Writer& out, const dem::LifetimeStatistics& lifetimes);

/// Does the file have one?
bool has_lifetimes(const Hdf5Reader& in);
dem::LifetimeStatistics read_lifetimes(const Hdf5Reader& in);

}  // namespace grainlaw::io
