#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::io {

/// A value that takes the place of what a TOML text says.
struct Override {
  std::string_view section;  ///< empty: top level
  std::string_view key;
  std::string value;  ///< as TOML
};

/// The text with these values in the lines of their keys, comments kept; an absent key is added.
/// It looks at lines only, not at inline tables or dotted keys: read the result to be sure.
std::string with_values(std::string text, const std::vector<Override>& overrides);

/// The text without the lines of a section, from its header to the next; read the result to be
/// sure.
std::string without_section(const std::string& text, std::string_view section);

/// The text after comment lines that state the values.
std::string with_comments(const std::string& text, const std::vector<Override>& overrides);

}  // namespace grainlaw::io
