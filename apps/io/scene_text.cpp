#include "apps/io/scene_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>

namespace grainlaw::io {
namespace {

constexpr std::string_view blanks = " \t\r";

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

/// "geometry" of the line "[geometry]  # comment".
std::optional<std::string_view> header_of(std::string_view line) {
  const std::string_view text = trimmed(line);
  const std::size_t end = text.find(']');
  if (!text.starts_with('[') || end == std::string_view::npos) return std::nullopt;
  return trimmed(text.substr(1, end - 1));
}

/// Where the value of a key begins in its line.
std::optional<std::size_t> value_of(std::string_view line, std::string_view key) {
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || trimmed(line.substr(0, equals)) != key) {
    return std::nullopt;
  }
  return std::min(line.find_first_not_of(blanks, equals + 1), line.size());
}

/// What follows the value: blanks and a comment. A quoted value may hold blanks and '#'.
std::size_t end_of_value(std::string_view line, std::size_t begin) {
  if (begin == line.size()) return begin;
  const char quote = line[begin];
  const bool quoted = quote == '"' || quote == '\'';
  const std::size_t end =
      quoted ? line.find(quote, begin + 1) + 1 : line.find_first_of(" \t\r#", begin);
  return end == 0 ? line.size() : std::min(end, line.size());
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::string line_of(const Override& change) {
  return fmt::format("{} = {}", change.key, change.value);
}

void apply(std::vector<std::string>& lines, const Override& change) {
  std::string section;
  auto home = change.section.empty() ? lines.begin() : lines.end();
  for (auto line = lines.begin(); line != lines.end(); ++line) {
    if (const auto header = header_of(*line)) {
      section = *header;
      if (section == change.section) home = line + 1;
    } else if (const auto begin = value_of(*line, change.key); begin && section == change.section) {
      line->replace(*begin, end_of_value(*line, *begin) - *begin, change.value);
      return;
    }
  }
  const bool no_section = home == lines.end() && section != change.section;
  home = lines.insert(home, line_of(change));
  if (no_section) lines.insert(home, fmt::format("[{}]", change.section));
}

}  // namespace

std::string with_values(std::string text, const std::vector<Override>& overrides) {
  std::vector<std::string> lines = lines_of(text);
  for (const Override& change : overrides) apply(lines, change);
  text.clear();
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

std::string without_section(const std::string& text, std::string_view section) {
  std::string kept;
  bool inside = false;
  for (const std::string& line : lines_of(text)) {
    if (const auto header = header_of(line)) inside = *header == section;
    if (!inside) kept += line + "\n";
  }
  return kept;
}

std::string with_comments(const std::string& text, const std::vector<Override>& overrides) {
  std::string out = "# The run differs from the text below in:\n";
  for (const Override& change : overrides) {
    out += fmt::format("#   {}{}\n",
                       change.section.empty() ? "" : fmt::format("[{}] ", change.section),
                       line_of(change));
  }
  return out + text;
}

}  // namespace grainlaw::io
