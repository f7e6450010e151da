#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/io/local_data_hdf5.h"
#include "apps/summary.h"

namespace grainlaw {

/// The checks of a run of another program, one line each.
void add_checks(Summary& summary, const io::RunRecord& record);

/// Those that failed, in words; runs with one are neither fitted nor scored.
std::vector<std::string> failed_checks(const std::vector<io::RunRecord>& imported);

/// Writes imported runs as local data, FOLDER/NAME.h5. Throws io::InputError where two have one
/// name or one of the inputs would be written over.
void store_imported(const std::vector<io::RunRecord>& imported,
                    const std::filesystem::path& folder,
                    const std::vector<std::string>& inputs);

}  // namespace grainlaw
