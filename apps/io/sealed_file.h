#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/io/checksum.h"

namespace grainlaw::io {

/// Bytes of the seal at the front of a file. HDF5 skips it as a user block.
inline constexpr std::size_t seal_bytes = 512;

/// Puts a seal in front of the content of a file: kind of file, format version, size, checksum, as
/// four lines of text (`head -4 FILE`).
std::string seal(std::string_view kind, int format, std::string_view content);

/// The content behind the seal, after everything the seal states was found to be true. Throws
/// ReadError, saying whether the file is foreign, of a newer format, cut short or changed.
std::string_view unseal(std::string_view kind,
                        int format,
                        std::string_view bytes,
                        const std::filesystem::path& path);

}  // namespace grainlaw::io
