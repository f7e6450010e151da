#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace grainlaw::io {

/// Unit of a key as words, and the size of one internal unit in it: internal = file / size.
struct Unit {
  std::string text;
  double size = 1.0;
};

/// Allowed values of a number; NaN never is.
struct Bounds {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_allowed = false;  ///< is the bound itself allowed
  bool upper_allowed = false;
  std::string_view unit = {};  ///< "d": multiples of the internal unit; empty: as in the file

  bool contain(double value) const;
  std::string text(std::string_view name) const;  ///< "0 < name <= 1"; empty: every number
};

inline constexpr Bounds any_number{};
inline constexpr Bounds positive{.lower = 0.0};
inline constexpr Bounds not_negative{.lower = 0.0, .lower_allowed = true};
inline constexpr Bounds positive_or_infinite{.lower = 0.0, .upper_allowed = true};
constexpr Bounds between(double lower, double upper) {
  return {lower, upper, false, false};
}
constexpr Bounds from_to(double lower, double upper) {
  return {lower, upper, true, true};
}
/// At least so many grain diameters, whatever the unit of length of the file.
constexpr Bounds diameters_or_more(double lower) {
  return {.lower = lower, .lower_allowed = true, .unit = "d"};
}

/// One key of an input file. Reading, checking and the key list of the documentation all come from
/// this one line.
struct Key {
  std::string_view name;
  std::string_view meaning;
  Unit unit = {};
  Bounds bounds = any_number;
};

/// A key as it was asked for, for messages and for the key list.
struct KeyEntry {
  std::string name;
  std::string type;     ///< "number", "integer", "text", ...
  std::string unit;     ///< empty: dimensionless
  std::string range;    ///< in words; empty: everything
  std::string missing;  ///< what a missing key means: "required", "optional" or the default
  std::string meaning;
};

/// A section as it was asked for. The top level has an empty name.
struct SectionEntry {
  std::string name;
  std::string variant;  ///< "kind = \"chute\"": only these keys; empty: always
  std::string meaning;
  bool required = false;
  std::vector<KeyEntry> keys;
};

/// The words with the separator between them.
std::string joined(const std::vector<std::string>& words, std::string_view separator);

/// A Markdown table for each section.
std::string markdown(const std::vector<SectionEntry>& sections);

/// Number of single-character changes between two words (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate a misspelt word most likely means; empty when none is near.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace grainlaw::io
