#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "apps/io/source_excerpt.h"

namespace grainlaw::io {

struct TomlEntry;

struct TomlTable {
  std::vector<TomlEntry> entries;
  const TomlEntry* find(std::string_view key) const;
};

/// A TOML type no key of ours has (dates and times).
struct TomlOther {
  std::string type;
};

/// One value of a TOML file and where it stands.
struct TomlValue {
  Place place;
  std::
      variant<TomlOther, bool, std::int64_t, double, std::string, std::vector<TomlValue>, TomlTable>
          value;

  const TomlTable* table() const { return std::get_if<TomlTable>(&value); }
  std::string type() const;  ///< "a number", "a list", ..., for messages
};

struct TomlEntry {
  std::string key;
  Place place;  ///< of the key
  TomlValue value;
};

/// Parses a text. Throws InputError with the place of a syntax error.
TomlValue parse_toml(const std::string& text, const std::filesystem::path& path);

}  // namespace grainlaw::io
