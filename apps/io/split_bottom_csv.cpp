#include "apps/io/split_bottom_csv.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

namespace grainlaw::io {
namespace {

using continuum::SplitBottomRow;

struct Column {
  const char* name;
  double SplitBottomRow::*member;
  Dimension dimension;
};
constexpr auto columns = std::to_array<Column>({
    {"z", &SplitBottomRow::z, dimension::length},
    {"radius", &SplitBottomRow::radius, dimension::length},
    {"width", &SplitBottomRow::width, dimension::length},
    {"pressure", &SplitBottomRow::pressure, dimension::stress},
    {"shear_rate", &SplitBottomRow::shear_rate, dimension::rate},
    {"inertial_number", &SplitBottomRow::inertial_number, dimension::number},
    {"friction", &SplitBottomRow::friction, dimension::number},
    {"volume_fraction", &SplitBottomRow::volume_fraction, dimension::number},
});

}  // namespace

std::string split_bottom_csv(const continuum::SplitBottom& cell, const Units& units) {
  std::string out = fmt::format("# {}: {}\n# units {}\n",
                                continuum::name(cell.answer.outcome),
                                cell.answer.text,
                                units.symbols());
  const char* separator = "";
  for (const Column& column : columns) {
    out += fmt::format("{}{} [{}]", separator, column.name, units.symbol(column.dimension));
    separator = ",";
  }
  for (const SplitBottomRow& row : cell.rows) {
    separator = "\n";
    for (const Column& column : columns) {
      out += fmt::format("{}{}", separator, row.*column.member * units.size(column.dimension));
      separator = ",";
    }
  }
  return out + "\n";
}

std::string split_bottom_json(const continuum::SplitBottom& cell, const Units& units) {
  nlohmann::ordered_json out;
  out["outcome"] = continuum::name(cell.answer.outcome);
  out["text"] = cell.answer.text;
  out["units"]["set"] = units.symbols();
  for (const Column& column : columns) {
    nlohmann::ordered_json& values = out["band"][column.name] = nlohmann::ordered_json::array();
    for (const SplitBottomRow& row : cell.rows)
      values.push_back(row.*column.member * units.size(column.dimension));
    out["units"][column.name] = units.symbol(column.dimension);
  }
  return out.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace grainlaw::io
