#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/io/input_file.h"

namespace grainlaw::io {

/// Writes a file that is either complete or not there: temporary file beside it, fsync, rename,
/// fsync of the directory. A file of that name stays intact until the rename.
/// Throws FileError with path and system error.
void safe_write(const std::filesystem::path& path, std::string_view bytes);

/// All bytes of a file, at most 4 GiB. Throws FileError.
std::string read_file(const std::filesystem::path& path);

}  // namespace grainlaw::io
