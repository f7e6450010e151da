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

/// Same, and the file that was there gets the name `previous`: at every moment one of the two is
/// there and complete. The parent folder of both is the same.
void safe_write_keeping(const std::filesystem::path& previous,
                        const std::filesystem::path& path,
                        std::string_view bytes);

/// Removes what killed writers of this file left beside it. Only for a program that knows, by a
/// lock, that nobody else is writing it now.
void remove_temporaries(const std::filesystem::path& path);

/// All bytes of a file of at most `largest` bytes. Throws ReadError.
std::string read_file(const std::filesystem::path& path,
                      std::size_t largest = std::size_t{4} << 30);

/// The same without the byte order mark that spreadsheets put in front of a text.
std::string read_text(const std::filesystem::path& path,
                      std::size_t largest = std::size_t{4} << 30);

}  // namespace grainlaw::io
