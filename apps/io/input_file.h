#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace grainlaw::io {

/// Bad input; what() is the whole message with file:line:column, the line, a caret and the remedy.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file that could not be written or read; what() names path and system error.
struct FileError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace grainlaw::io
