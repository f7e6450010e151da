#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace grainlaw::io {

/// A place in a text, counted from 1; columns count characters, not bytes.
struct Place {
  std::size_t line = 1;
  std::size_t column = 1;
  std::size_t width = 1;  ///< characters to underline
};

/// "file:line:column: error: message", the line itself, and a caret under the place followed by the
/// hint. Bytes that do not print are shown as '?', long lines are cut around the place.
std::string excerpt(std::string_view file,
                    std::string_view text,
                    const Place& place,
                    std::string_view message,
                    std::string_view hint = {});

/// A piece of a file to quote in a message: bytes that do not print are shown as '?', a long one is
/// cut.
std::string quotable(std::string_view piece);

}  // namespace grainlaw::io
