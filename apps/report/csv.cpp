#include "apps/report/csv.h"

#include <array>
#include <charconv>
#include <cmath>

namespace grainlaw::report {
namespace {

std::string field(const std::string& name) {
  return name;
}

std::string field(double number) {
  if (!std::isfinite(number)) return {};
  std::array<char, 32> digits{};
  const auto result = std::to_chars(
      digits.data(), digits.data() + digits.size(), number, std::chars_format::general, 10);
  return {digits.data(), result.ptr};
}

template <class Field>
void append_row(std::string& text, const std::vector<Field>& row) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) text += ',';
    text += field(row[i]);
  }
  text += '\n';
}

}  // namespace

std::string Csv::text() const {
  std::string result;
  append_row(result, columns);
  for (const std::vector<double>& row : rows) append_row(result, row);
  return result;
}

}  // namespace grainlaw::report
