#include "apps/io/source_excerpt.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace grainlaw::io {
namespace {

constexpr std::size_t shown_columns = 100;

std::string_view line_of(std::string_view text, std::size_t number) {
  for (; number > 1; --number) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

/// Bytes of the UTF-8 character at the front; 0 when there is none.
std::size_t character_bytes(std::string_view text) {
  const auto first = static_cast<unsigned char>(text.front());
  const std::size_t bytes = first < 0x80                    ? 1
                            : first >= 0xc2 && first < 0xe0 ? 2
                            : first >= 0xe0 && first < 0xf0 ? 3
                            : first >= 0xf0 && first < 0xf5 ? 4
                                                            : 0;
  if (bytes > text.size()) return 0;
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
  return std::ranges::all_of(text.substr(1, bytes > 1 ? bytes - 1 : 0), continues) ? bytes : 0;
}

bool prints(std::string_view character) {
  const auto first = static_cast<unsigned char>(character.front());
  // U+0080 to U+009F are control characters of terminals.
  const bool c1_control = first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
  return first >= 0x20 && first != 0x7f && !c1_control;
}

/// The line as single characters that are safe to print.
std::vector<std::string> printable_characters(std::string_view line) {
  std::vector<std::string> result;
  while (!line.empty()) {
    const std::size_t bytes = character_bytes(line);
    const std::string_view character = line.substr(0, std::max<std::size_t>(bytes, 1));
    if (character == "\t") {
      result.emplace_back(" ");
    } else if (character != "\r") {
      result.emplace_back(bytes > 0 && prints(character) ? character : "?");
    }
    line.remove_prefix(character.size());
  }
  return result;
}

}  // namespace

std::string excerpt(std::string_view file,
                    std::string_view text,
                    const Place& place,
                    std::string_view message,
                    std::string_view hint) {
  const std::vector<std::string> line = printable_characters(line_of(text, place.line));
  const std::size_t column = std::min(place.column - 1, line.size());
  const std::size_t begin = column > shown_columns ? column - shown_columns / 2 : 0;
  const std::size_t end = std::min(line.size(), begin + shown_columns);
  const std::size_t width =
      std::clamp<std::size_t>(place.width, 1, std::max(end, column + 1) - column);
  std::string shown;
  for (std::size_t k = begin; k < end; ++k) shown += line[k];
  std::string out = fmt::format("{}:{}:{}: error: {}\n{:5} | {}\n      | {:>{}}",
                                file,
                                place.line,
                                place.column,
                                message,
                                place.line,
                                shown,
                                std::string(width, '^'),
                                column - begin + width);
  if (!hint.empty()) out += fmt::format("  {}", hint);
  return out;
}

std::string quotable(std::string_view piece) {
  std::string shown;
  std::size_t count = 0;
  for (const std::string& character : printable_characters(piece)) {
    if (++count > shown_columns) return shown + "...";
    shown += character;
  }
  return shown;
}

}  // namespace grainlaw::io
