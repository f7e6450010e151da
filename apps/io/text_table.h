#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/io/source_excerpt.h"

namespace grainlaw::io {

/// A number of a table and where it stands; NaN where the file has no number.
struct TableCell {
  double value = std::numeric_limits<double>::quiet_NaN();
  std::size_t begin = 0;  ///< in its line, counted from 0
  std::size_t width = 1;
};

struct TableRow {
  std::size_t line = 1;
  std::vector<TableCell> cells;  ///< as many as there are columns
};

/// The rows of one time; a file of averages has a single block without a time.
struct TableBlock {
  double time = std::numeric_limits<double>::quiet_NaN();  ///< as in the file
  std::vector<TableRow> rows;
};

/// Numbers in a text of another program: columns with names, rows in blocks of equal time.
struct TextTable {
  std::filesystem::path path;
  std::string text;
  std::vector<std::string> names;
  std::vector<Place> name_places;  ///< of a CSV file
  std::size_t names_line = 1;
  std::vector<TableBlock> blocks;

  std::optional<std::size_t> find(std::string_view name) const;
  /// `purpose` says what it is for. Throws InputError naming file, line and the columns there are.
  std::size_t column(std::string_view name, std::string_view purpose) const;
  /// Throws InputError with file, line and column where it is not a finite number.
  double number(const TableRow& row, std::size_t column) const;
  [[noreturn]] void fail(const Place& place,
                         std::string_view message,
                         std::string_view hint = {}) const;
};

/// Comment lines that begin with '#', a line of names, a line of numbers for each row, commas
/// between. With a column of that name, rows of equal `time` are a block.
TextTable read_csv(const std::filesystem::path& path, std::string_view time = {});

/// Output of LAMMPS `fix ave/chunk`: comment lines, the last one with the names; blocks of a line
/// with time step, number of chunks and count, and a line for each chunk. The time is the step.
TextTable read_lammps_chunk(const std::filesystem::path& path);

/// Output of MercuryCG (MercuryDPM, Kernel/CG: CG::write, StandardFields::writeNames): a line about
/// the coarse graining, a line of names such as `time z 3:VolumeFraction 5-7:Momentum`, a line for
/// each time and height. Names are told apart by their letters alone, without case; those of
/// vectors and tensors get components: momentumx, momentumfluxxx .. zz, contactstressxx .. zz.
TextTable read_mercury_cg(const std::filesystem::path& path);

}  // namespace grainlaw::io
