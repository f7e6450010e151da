#include "apps/io/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <span>

#include "apps/io/input_state.h"
#include "apps/io/safe_write.h"

namespace grainlaw::io {
namespace {

constexpr std::string_view blanks = " \t\r";
constexpr std::size_t largest_table = std::size_t{1} << 30;  // bytes

struct Word {
  std::string_view text;
  std::size_t begin = 0;
};

std::vector<Word> words_of(std::string_view line) {
  std::vector<Word> words;
  for (std::size_t at = line.find_first_not_of(blanks); at < line.size();
       at = line.find_first_not_of(blanks, at)) {
    const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
    words.push_back({line.substr(at, end - at), at});
    at = end;
  }
  return words;
}

std::vector<Word> comma_separated(std::string_view line) {
  std::vector<Word> words;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    const std::string_view piece = line.substr(begin, end - begin);
    const std::size_t skipped = std::min(piece.find_first_not_of(blanks), piece.size());
    const std::string_view text =
        piece.substr(skipped, piece.find_last_not_of(blanks) + 1 - skipped);
    words.push_back({text, begin + skipped});
    begin = end + 1;
  }
  return words;
}

TableCell cell_of(const Word& word) {
  TableCell cell{.begin = word.begin, .width = std::max<std::size_t>(word.text.size(), 1)};
  const char* const end = word.text.data() + word.text.size();
  double value = 0.0;
  const auto [stop, error] = std::from_chars(word.text.data(), end, value);
  if (error == std::errc() && stop == end) cell.value = value;
  return cell;
}

/// The lines of a table one after the other, without empty ones.
class Lines {
 public:
  explicit Lines(const TextTable& table) : table_(table) {}

  bool next() {
    const std::string_view text = table_.text;
    while (begin_ < text.size()) {
      const std::size_t end = std::min(text.find('\n', begin_), text.size());
      line_ = text.substr(begin_, end - begin_);
      begin_ = end + 1;
      ++number_;
      if (line_.find_first_not_of(blanks) != std::string_view::npos) return true;
    }
    line_ = {};
    return false;
  }
  std::string_view line() const { return line_; }
  std::size_t number() const { return std::max<std::size_t>(number_, 1); }

  [[noreturn]] void fail(std::string_view message, std::string_view hint = {}) const {
    table_.fail({number(), 1, std::max<std::size_t>(line_.size(), 1)}, message, hint);
  }
  TableRow row(std::span<const Word> words) const {
    if (words.size() != table_.names.size()) {
      fail(fmt::format("{} values for {} columns", words.size(), table_.names.size()));
    }
    TableRow row{.line = number(), .cells = {}};
    for (const Word& word : words) row.cells.push_back(cell_of(word));
    return row;
  }

 private:
  const TextTable& table_;
  std::string_view line_;
  std::size_t begin_ = 0;
  std::size_t number_ = 0;
};

TextTable open(const std::filesystem::path& path) {
  TextTable table;
  table.path = path;
  table.text = read_text(path, largest_table);
  return table;
}

void require_rows(const TextTable& table, const Lines& lines) {
  if (table.blocks.empty()) lines.fail("no rows: a line of numbers for each is expected");
}

/// Puts a row into the block of its time.
void add(TextTable& table, TableRow row, double time) {
  const bool same = !table.blocks.empty() && (std::isnan(time) || table.blocks.back().time == time);
  if (!same) table.blocks.push_back({.time = time, .rows = {}});
  table.blocks.back().rows.push_back(std::move(row));
}

void read_names(TextTable& table, const Lines& lines, std::span<const Word> words) {
  table.names_line = lines.number();
  for (const Word& word : words) {
    const Place place{lines.number(), word.begin + 1, std::max<std::size_t>(word.text.size(), 1)};
    if (table.find(word.text)) {
      table.fail(place, fmt::format("column '{}' is there twice", quotable(word.text)));
    }
    table.names.emplace_back(word.text);
    table.name_places.push_back(place);
  }
}

/// A name of MercuryCG with the columns it stands for: "5-7:Momentum".
void add_components(TextTable& table, const Lines& lines, std::string_view word) {
  constexpr std::array<std::string_view, 3> vector{"x", "y", "z"};
  constexpr std::array<std::string_view, 6> symmetric{"xx", "xy", "xz", "yy", "yz", "zz"};
  constexpr std::array<std::string_view, 9> full{
      "xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  const std::size_t colon = word.find(':');
  std::string name;
  for (const char c : colon == std::string_view::npos ? word : word.substr(colon + 1)) {
    name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  std::size_t first = 1;
  std::size_t last = 1;
  if (const std::size_t dash = word.find('-'); dash < colon && colon != std::string_view::npos) {
    std::from_chars(word.data(), word.data() + dash, first);
    std::from_chars(word.data() + dash + 1, word.data() + colon, last);
  }
  const std::size_t count = last >= first ? last - first + 1 : 0;
  if (count == 0 || count > 99) lines.fail(fmt::format("cannot read '{}'", quotable(word)));
  for (std::size_t k = 0; k < count; ++k) {
    std::string component = count == 1 ? "" : fmt::format("{}", k);
    if (count == 3) component = vector[k];
    if (count == 6) component = symmetric[k];
    if (count == 9) component = full[k];
    table.names.push_back(name + component);
  }
}

void read_mercury_names(TextTable& table, Lines& lines) {
  constexpr auto expected =
      "expected: output of MercuryCG, whose first line begins with the kind "
      "of coarse graining, e.g. 'CG id 0 n 1 1 40 width 0.5'";
  if (!lines.next()) lines.fail("the file is empty", expected);
  if (lines.line().starts_with("Nu ") || lines.line().find(" Nu ") != std::string_view::npos) {
    lines.fail("this is the format of fstatistics, which MercuryCG replaced", expected);
  }
  if (words_of(lines.line()).front().text.find("CG") == std::string_view::npos) {
    lines.fail("no output of MercuryCG", expected);
  }
  if (!lines.next()) lines.fail("no line of column names", expected);
  table.names_line = lines.number();
  for (const Word& word : words_of(lines.line())) add_components(table, lines, word.text);
  for (const char* coordinate : {"x", "y", "r", "phi"}) {
    if (table.find(coordinate)) {
      lines.fail(fmt::format("fields over {}: profiles over z alone are wanted", coordinate),
                 "coarse-grain with -coordinates Z");
    }
  }
}

}  // namespace

std::optional<std::size_t> TextTable::find(std::string_view name) const {
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

std::size_t TextTable::column(std::string_view name, std::string_view purpose) const {
  if (const auto found = find(name)) return *found;
  const std::string guess = nearest(name, names);
  fail({names_line, 1, 1},
       fmt::format("no column '{}' ({}){}",
                   name,
                   purpose,
                   guess.empty() ? "" : did_you_mean("'" + guess + "'")),
       "the columns are " + joined(names, ", "));
}

double TextTable::number(const TableRow& row, std::size_t column) const {
  const TableCell& cell = row.cells[column];
  if (std::isfinite(cell.value)) return cell.value;
  fail({row.line, cell.begin + 1, cell.width},
       fmt::format("'{}' has no finite number here", names[column]));
}

void TextTable::fail(const Place& place, std::string_view message, std::string_view hint) const {
  throw InputError(excerpt(path.string(), text, place, message, hint));
}

TextTable read_csv(const std::filesystem::path& path, std::string_view time) {
  TextTable table = open(path);
  Lines lines(table);
  do {
    if (!lines.next()) lines.fail("no line of column names");
  } while (lines.line().starts_with('#'));
  read_names(table, lines, comma_separated(lines.line()));
  const std::optional<std::size_t> at =
      time.empty() ? std::nullopt : std::optional(table.column(time, "time"));
  while (lines.next()) {
    TableRow row = lines.row(comma_separated(lines.line()));
    const double when = at ? table.number(row, *at) : TableBlock{}.time;
    add(table, std::move(row), when);
  }
  require_rows(table, lines);
  return table;
}

TextTable read_lammps_chunk(const std::filesystem::path& path) {
  constexpr auto expected = "expected: output of fix ave/chunk, with comment lines in front";
  TextTable table = open(path);
  Lines lines(table);
  std::string_view names;
  while (lines.next() && lines.line().starts_with('#')) {
    names = lines.line().substr(1);
    table.names_line = lines.number();
  }
  if (!words_of(names).empty() && words_of(names).front().text == "Chunk") {
    for (const Word& word : words_of(names)) table.names.emplace_back(word.text);
  } else {
    lines.fail("no line '# Chunk Coord1 ...' with the column names", expected);
  }
  for (bool more = !lines.line().empty(); more; more = lines.next()) {
    const std::vector<Word> head = words_of(lines.line());
    const double step = cell_of(head.front()).value;
    const double chunks = head.size() == 3 ? cell_of(head[1]).value : 0.0;
    if (!std::isfinite(step) || !(chunks >= 1.0 && chunks <= 1e7)) {
      lines.fail("a time step, a number of chunks and a count are expected here", expected);
    }
    table.blocks.push_back({.time = step, .rows = {}});
    for (int k = 0; k < static_cast<int>(chunks); ++k) {
      if (!lines.next()) {
        lines.fail(fmt::format("the file ends after {} of {} chunks of step {}", k, chunks, step),
                   "remove this last block: it was not written to its end");
      }
      table.blocks.back().rows.push_back(lines.row(words_of(lines.line())));
    }
  }
  require_rows(table, lines);
  return table;
}

TextTable read_mercury_cg(const std::filesystem::path& path) {
  TextTable table = open(path);
  Lines lines(table);
  read_mercury_names(table, lines);
  const std::size_t time = table.column("time", "time");
  while (lines.next()) {
    TableRow row = lines.row(words_of(lines.line()));
    const double when = table.number(row, time);
    add(table, std::move(row), when);
  }
  require_rows(table, lines);
  return table;
}

}  // namespace grainlaw::io
