#include "apps/io/start_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "apps/io/input_state.h"
#include "apps/io/safe_write.h"
#include "apps/io/source_excerpt.h"

namespace grainlaw::io {
namespace {

/// One column: where its numbers go, and their unit.
struct Column {
  std::string_view name;
  Dimension dimension;
  double& (*target)(dem::StartGrain&);  ///< none: frozen
};
constexpr auto columns = std::to_array<Column>({
    {"x", dimension::length, [](dem::StartGrain& g) -> double& { return g.position.x; }},
    {"y", dimension::length, [](dem::StartGrain& g) -> double& { return g.position.y; }},
    {"z", dimension::length, [](dem::StartGrain& g) -> double& { return g.position.z; }},
    {"vx", dimension::velocity, [](dem::StartGrain& g) -> double& { return g.velocity.x; }},
    {"vy", dimension::velocity, [](dem::StartGrain& g) -> double& { return g.velocity.y; }},
    {"vz", dimension::velocity, [](dem::StartGrain& g) -> double& { return g.velocity.z; }},
    {"wx", dimension::rate, [](dem::StartGrain& g) -> double& { return g.rotation.x; }},
    {"wy", dimension::rate, [](dem::StartGrain& g) -> double& { return g.rotation.y; }},
    {"wz", dimension::rate, [](dem::StartGrain& g) -> double& { return g.rotation.z; }},
    {"diameter", dimension::length, [](dem::StartGrain& g) -> double& { return g.diameter; }},
    {"frozen", dimension::number, nullptr},
});
constexpr std::size_t required_columns = 3;

/// A text between two commas and its place in the line, counted from 0.
struct Cell {
  std::string_view text;
  std::size_t begin = 0;
};

std::vector<Cell> cells_of(std::string_view line) {
  constexpr std::string_view blanks = " \t";
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view text = line.substr(begin, end - begin);
    const std::size_t skipped = std::min(text.find_first_not_of(blanks), text.size());
    text.remove_prefix(skipped);
    text = text.substr(0, text.find_last_not_of(blanks) + 1);
    cells.push_back({text, begin + skipped});
    begin = end + 1;
  }
  return cells;
}

/// The lines of the file one after the other.
class StartReader {
 public:
  StartReader(const std::filesystem::path& path, const Units& units)
      : path_(path), text_(read_text(path)), units_(units) {}

  std::vector<dem::StartGrain> read() {
    read_names();
    std::vector<dem::StartGrain> grains;
    while (next_line()) grains.push_back(read_grain());
    if (grains.empty()) fail({}, "no grains: a line of numbers for each is expected");
    return grains;
  }

 private:
  /// Skips empty lines, and comments before the names of the columns.
  bool next_line() {
    while (begin_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin_), text_.size());
      line_ = std::string_view(text_).substr(begin_, end - begin_);
      if (line_.ends_with('\r')) line_.remove_suffix(1);
      begin_ = end + 1;
      ++number_;
      if (!line_.empty() && !(order_.empty() && line_.starts_with('#'))) return true;
    }
    line_ = {};
    return false;
  }

  void read_names() {
    constexpr auto expected = "the columns are x,y,z,vx,vy,vz,wx,wy,wz,diameter,frozen";
    if (!next_line()) fail({}, "no line of column names", expected);
    for (const Cell& cell : cells_of(line_)) {
      const auto* const column = std::ranges::find(columns, cell.text, &Column::name);
      if (column == columns.end()) {
        fail(cell, fmt::format("unknown column '{}'", quotable(cell.text)), expected);
      }
      if (std::ranges::count(order_, column) > 0) {
        fail(cell, fmt::format("column '{}' is there twice", cell.text));
      }
      order_.push_back(column);
    }
    for (const Column& column : std::span(columns).first(required_columns)) {
      if (std::ranges::count(order_, &column) == 0) {
        fail({}, fmt::format("missing column '{}'", column.name), expected);
      }
    }
  }

  dem::StartGrain read_grain() const {
    const std::vector<Cell> cells = cells_of(line_);
    if (cells.size() != order_.size()) {
      fail({}, fmt::format("{} values for {} columns", cells.size(), order_.size()));
    }
    dem::StartGrain grain;
    for (std::size_t k = 0; k < cells.size(); ++k) read_value(cells[k], *order_[k], grain);
    return grain;
  }

  void read_value(const Cell& cell, const Column& column, dem::StartGrain& grain) const {
    const double value = number(cell);
    if (column.target != nullptr) {
      column.target(grain) = value / units_.size(column.dimension);
    } else {
      if (value != 0.0 && value != 1.0) fail(cell, "'frozen' must be 0 or 1");
      grain.frozen = value == 1.0;
    }
    if (column.name == "diameter" && value <= 0.0) fail(cell, "a diameter must be positive");
  }

  double number(const Cell& cell) const {
    double value = 0.0;
    const char* const end = cell.text.data() + cell.text.size();
    const auto [stop, error] = std::from_chars(cell.text.data(), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) {
      fail(cell, fmt::format("'{}' is not a finite number", quotable(cell.text)));
    }
    return value;
  }

  [[noreturn]] void fail(const Cell& at,
                         const std::string& message,
                         const std::string& hint = {}) const {
    const Place place{
        std::max<std::size_t>(number_, 1), at.begin + 1, std::max<std::size_t>(at.text.size(), 1)};
    throw InputError(excerpt(path_.string(), text_, place, message, hint));
  }

  std::filesystem::path path_;
  std::string text_;
  const Units& units_;
  std::vector<const Column*> order_;
  std::string_view line_;
  std::size_t begin_ = 0;
  std::size_t number_ = 0;
};

}  // namespace

std::vector<dem::StartGrain> read_start(const std::filesystem::path& path, const Units& units) {
  return StartReader(path, units).read();
}

}  // namespace grainlaw::io
