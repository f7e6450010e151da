#pragma once

#include <string>

#include "apps/io/hdf5_file.h"
#include "dem/local_data.h"

namespace grainlaw::io {

/// Did the grains of a run have friction? Without it nothing about sliding is in the file.
bool slides(const dem::ProfileFrames& frames);

/// The attribute `kernel` of a group.
dem::KernelShape read_kernel_shape(const Hdf5Reader& in, const std::string& group);

/// How many digits of the moments are stored. Single is exact for those of reduced data.
enum class Precision { single, full };

/// Group /frames: the moments of every bin over time.
void write_frames(Hdf5Writer& out, const dem::ProfileFrames& frames, Precision precision);
dem::ProfileFrames read_frames(const Hdf5Reader& in);

/// Group /fields: all fields at half, once and twice the width of the kernel.
void write_widths(Hdf5Writer& out, const dem::LocalData& data);
std::vector<dem::WidthFields> read_widths(const Hdf5Reader& in, bool friction);

}  // namespace grainlaw::io
