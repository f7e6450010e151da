#pragma once

#include <string>
#include <vector>

namespace grainlaw::report {

/// A table of numbers for a file: one head row, units in the column names, NaN as an empty field.
struct Csv {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;

  std::string text() const;
};

}  // namespace grainlaw::report
