#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/io/input_key.h"
#include "apps/io/source_excerpt.h"
#include "apps/io/toml_tree.h"

namespace grainlaw::io {

inline constexpr std::size_t problems_shown = 20;

/// Something wrong with an input file.
struct Problem {
  Place place;
  std::string text;
  std::string hint;
  std::string section;
  std::vector<std::string> missing;  ///< keys or sections whose absence is the problem
};

/// "in [contact.normal]", "at the top level".
std::string title(std::string_view section);

/// "; did you mean GUESS?"
std::string did_you_mean(std::string_view guess);

/// What is shared by the sections of one input file.
struct InputState {
  std::filesystem::path path;
  std::string text;
  TomlTable root;
  bool listing = false;
  std::vector<SectionEntry> asked;
  std::vector<Problem> problems;
  std::set<std::pair<std::string, std::string>> refused;  ///< section and key of a wrong value

  const TomlTable* table(std::string_view section) const;
  const TomlEntry* find(std::string_view section, std::string_view key) const;
  /// Of the key; of its section where the key is absent; of the file where that is absent too.
  Place place(std::string_view section, std::string_view key) const;
  SectionEntry& entry(std::string_view section, std::string_view variant = "");
  std::vector<std::string> known_keys(std::string_view section) const;
  std::vector<std::string> known_sections() const;
  /// Reports every key and section nobody asked for.
  void find_unknown(const TomlTable& in, const std::string& section);
  std::string home_of(std::string_view key) const;
  void report_unknown(const TomlEntry& found, const std::string& section);
  void report_unknown_section(const TomlEntry& found, const std::string& name);
  void report_no_section(const TomlValue& found, Place at, const std::string& name);
  void withdraw_missing(std::string_view section, const std::string& name);
};

}  // namespace grainlaw::io
