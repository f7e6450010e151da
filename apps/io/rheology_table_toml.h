#pragma once

#include <filesystem>
#include <string>

#include "apps/io/units.h"
#include "continuum/rheology_table.h"

namespace grainlaw::io {

/// Reads and validates a table. Throws InputError.
continuum::RheologyTable read_table(const std::filesystem::path& path);
continuum::RheologyTable parse_table(const std::string& text, const std::filesystem::path& path);

/// The table as TOML. Numbers have the fewest digits that give the same bits again, so that
/// writing, reading and writing gives the same bytes.
std::string to_toml(const continuum::RheologyTable& table);

/// Writes a valid table; what is written was read back before. Throws continuum::TableError,
/// InputError, FileError.
void write_table(const continuum::RheologyTable& table, const std::filesystem::path& path);

/// The table with a, b, tau_c in internal units (set "grain"). A table in another set can only be
/// used with a case in that set, which gives the sizes: otherwise InputError.
continuum::RheologyTable in_grain_units(const continuum::RheologyTable& table, const Units& units);

/// The keys of a table file as Markdown.
std::string table_keys();

}  // namespace grainlaw::io
