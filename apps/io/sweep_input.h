#pragma once

#include "apps/io/case_input.h"
#include "apps/io/input_file.h"

namespace grainlaw::io {

/// The section [sweep] of a chute, whose other keys have been read.
void read_sweep(InputFile& in, CaseFile& file);

}  // namespace grainlaw::io
