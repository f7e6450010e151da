#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/io/units.h"
#include "dem/local_data.h"

namespace grainlaw::io {

enum class ImportFormat { csv, lammps_chunk, mercury_cg };

/// What the stress columns of a file hold.
enum class StressContent {
  total,     ///< contact and kinetic part
  contact,   ///< contact part
  per_grain  ///< contact part times volume, the mean over the grains (LAMMPS compute stress/atom)
};

/// Signs of the normal and of the shear stress of a layer that flows along +x, z upwards.
enum class StressSigns {
  both_positive,  ///< both positive, as in local data
  tension,        ///< tensor, tension positive: normal negative, shear positive
  compression,    ///< tensor, compression positive: normal positive, shear negative
};

/// A column of the data file and what its numbers are to be multiplied by.
struct ImportColumn {
  std::string name;
  double factor = 1.0;
  Dimension dimension;
  bool stated = false;  ///< in the import file; the others are taken where they are there
};

/// What has to be known to read profiles of another program as local data. In internal units.
struct Import {
  std::string name;
  ImportFormat format = ImportFormat::csv;
  std::filesystem::path file;
  Units units;
  dem::ChuteConditions conditions;  ///< mass per area 0: that of the rows
  double base_top = 0.0;            ///< height of z = 0 in the file
  double time_step = 1.0;           ///< unit of the times of the file
  StressContent stress = StressContent::total;
  StressSigns signs = StressSigns::both_positive;
  std::map<std::string, ImportColumn, std::less<>> columns;  ///< by the names of our fields
  std::optional<double> relative_error;  ///< of fields without a column of errors
  bool steady = false;                   ///< stated of averages
  bool from_rest = false;                ///< the first block begins when the flow starts from rest
  double averaging_time = 0.0;           ///< least length of a steady window; 0: a quarter
  std::string program;
  double wall_seconds = 0.0;  ///< 0: not known
  std::string text;           ///< of the import file
};

/// Reads an import file; the data file is relative to it. Throws InputError.
Import read_import_input(const std::filesystem::path& path);

/// The keys of an import file as Markdown.
std::string import_keys();

}  // namespace grainlaw::io
