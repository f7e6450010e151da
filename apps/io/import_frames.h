#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "apps/io/import_input.h"
#include "apps/io/text_table.h"
#include "dem/profile_frames.h"

namespace grainlaw::io {

/// The columns of a data file as our fields, in internal units.
class Columns {
 public:
  Columns(const Import& import, const TextTable& table) : import_(import), table_(table) {}

  /// Is the field there? One that the import file names has to be.
  bool has(std::string_view field) const {
    const auto found = import_.columns.find(field);
    if (found == import_.columns.end()) return false;
    if (found->second.stated) table_.column(found->second.name, field);
    return table_.find(found->second.name).has_value();
  }
  double value(const TableRow& row, std::string_view field) const {
    const auto found = import_.columns.find(field);
    if (found == import_.columns.end()) {
      table_.fail({table_.names_line, 1, 1},
                  fmt::format("no column is named as {}", field),
                  fmt::format("name it in [columns]: {} = \"...\"", field));
    }
    const ImportColumn& column = found->second;
    const double number = table_.number(row, table_.column(column.name, field));
    return number * column.factor / import_.units.size(column.dimension);
  }
  double value_or(const TableRow& row, std::string_view field, double otherwise) const {
    return has(field) ? value(row, field) : otherwise;
  }
  [[noreturn]] void fail(const TableRow& row, const std::string& message) const {
    table_.fail({row.line, 1, 1}, message);
  }
  /// A column of MercuryCG.
  double raw(const TableRow& row, std::string_view name, Dimension dimension) const {
    return table_.number(row, table_.column(name, "MercuryCG")) / import_.units.size(dimension);
  }

 private:
  const Import& import_;
  const TextTable& table_;
};

/// The blocks of a table as frames, z counted from the base; a single block gets the time 0.
dem::ProfileFrames frames_of(const Import& import, const TextTable& table);

}  // namespace grainlaw::io
