#pragma once

#include "apps/io/case_input.h"
#include "apps/io/input_file.h"

namespace grainlaw::io {

/// Reads [geometry] and [nonlocal] of a case without [chute], and the units of its file. `geometry`
/// was found in the file.
void read_flow(InputFile& in, Section& geometry, CaseFile& file);

}  // namespace grainlaw::io
