#include "apps/io/start_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "apps/io/input_state.h"
#include "apps/io/text_table.h"

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

/// What each column of the table holds.
std::vector<const Column*> meanings(const TextTable& table) {
  std::vector<const Column*> order;
  for (std::size_t k = 0; k < table.names.size(); ++k) {
    const auto* const column = std::ranges::find(columns, table.names[k], &Column::name);
    if (column == columns.end()) {
      table.fail(table.name_places[k],
                 fmt::format("unknown column '{}'", quotable(table.names[k])),
                 "the columns are x,y,z,vx,vy,vz,wx,wy,wz,diameter,frozen");
    }
    order.push_back(column);
  }
  for (const Column& column : std::span(columns).first(required_columns)) {
    table.column(column.name, "positions of the grains");
  }
  return order;
}

void take(const TextTable& table,
          const TableRow& row,
          std::size_t k,
          const Column& column,
          const Units& units,
          dem::StartGrain& grain) {
  const double value = table.number(row, k);
  const auto fail = [&](std::string_view message) {
    table.fail({row.line, row.cells[k].begin + 1, row.cells[k].width}, message);
  };
  if (column.target != nullptr) {
    column.target(grain) = value / units.size(column.dimension);
  } else {
    if (value != 0.0 && value != 1.0) fail("'frozen' must be 0 or 1");
    grain.frozen = value == 1.0;
  }
  if (column.name == "diameter" && value <= 0.0) fail("a diameter must be positive");
}

}  // namespace

std::vector<dem::StartGrain> read_start(const std::filesystem::path& path, const Units& units) {
  const TextTable table = read_csv(path);
  const std::vector<const Column*> order = meanings(table);
  std::vector<dem::StartGrain> grains;
  for (const TableRow& row : table.blocks.front().rows) {
    dem::StartGrain& grain = grains.emplace_back();
    for (std::size_t k = 0; k < order.size(); ++k) take(table, row, k, *order[k], units, grain);
  }
  return grains;
}

}  // namespace grainlaw::io
