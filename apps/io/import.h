#pragma once

#include <filesystem>

#include "apps/io/import_input.h"
#include "apps/io/local_data_hdf5.h"

namespace grainlaw::io {

/// Profiles of another program as local data, by the mapping of an import file. Blocks of time
/// become frames, so that steadiness and standard errors come from the same statistics as those of
/// our own runs; averages without a history take the errors their file states. A run that fails a
/// check is not steady, with the reason in its window. Throws InputError naming file and line.
RunRecord import_run(const Import& import);

/// Local data of a run (RUN.h5), or of another program (an import file, by its ending .toml).
RunRecord read_run(const std::filesystem::path& path);

}  // namespace grainlaw::io
