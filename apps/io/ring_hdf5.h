#pragma once

#include "apps/io/hdf5_file.h"
#include "dem/ring_grid.h"

namespace grainlaw::io {

/// Group /grid: fields of a ring cell over height and radius, [z][r], with standard errors.
void write_ring(Hdf5Writer& out, const dem::RingFields& ring);
bool has_ring(const Hdf5Reader& in);
dem::RingFields read_ring(const Hdf5Reader& in);

}  // namespace grainlaw::io
