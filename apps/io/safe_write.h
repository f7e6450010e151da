#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "apps/io/input_file.h"

namespace grainlaw::io {

/// Writes a file that is either complete or not there: temporary file beside it, fsync, rename,
/// fsync of the directory. A file of that name stays intact until the rename.
/// Throws FileError with path and system error.
void safe_write(const std::filesystem::path& path, std::string_view bytes);

/// All bytes of a file of at most `largest` bytes. Throws ReadError.
std::string read_file(const std::filesystem::path& path,
                      std::size_t largest = std::size_t{4} << 30);

}  // namespace grainlaw::io
