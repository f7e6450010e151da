#include "apps/report/csv.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

namespace grainlaw::report {
namespace {

std::string field(double number) {
  return std::isfinite(number) ? fmt::format("{:.10g}", number) : std::string{};
}

}  // namespace

std::string Csv::text() const {
  std::string result = fmt::format("{}\n", fmt::join(columns, ","));
  for (const std::vector<double>& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) result += (i > 0 ? "," : "") + field(row[i]);
    result += '\n';
  }
  return result;
}

}  // namespace grainlaw::report
