#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/io/scene_input.h"
#include "dem/local_data.h"

namespace grainlaw::io {

enum class CheckOutcome { passed, failed, not_possible };
std::string_view name(CheckOutcome outcome);

/// A check of data of another program.
struct ImportCheck {
  std::string name;  ///< one word: what was checked
  CheckOutcome outcome = CheckOutcome::passed;
  std::string text;  ///< a sentence with the numbers
};

/// A local data file: the data of a run and what made them.
struct RunRecord {
  dem::LocalData data;     ///< in internal units (m = d = g = 1)
  std::string scene_text;  ///< imported data: of the import file
  Units units;             ///< of the scene text
  std::uint64_t seed = 0;
  std::string version;  ///< of the program
  std::string host;     ///< where, when and on how many cores it ran; group /run
  std::string date;
  int cores = 0;
  std::string imported_from;  ///< another program, in words; empty: a run of ours
  std::vector<ImportCheck> checks;
  std::string reduced_from;  ///< digest of the file whose frames were joined; empty: they were not
};

/// Writes local data with the scene they belong to. The same run gives the same bytes outside the
/// group /run. In Python:
///     file = h5py.File("run.h5")
///     z, v, error = (file["rows"][name][:] for name in ("z", "velocity", "velocity_error"))
///     theta, unit = file["conditions"].attrs["inclination"], file["rows/velocity"].attrs["unit"]
/// (h5py gives texts as bytes: unit.decode().)
/// Safe to call from several threads. Throws FileError.
void write_local_data(const dem::LocalData& data,
                      const SceneFile& scene,
                      const std::filesystem::path& path);

/// The same for imported data, whose record is complete but for host, date and cores.
void write_imported_data(const RunRecord& record, const std::filesystem::path& path);

/// A record with its frames joined (dem::reduced), a small part of the size. Everything else stays,
/// group /run included; the attribute `from` of the group /reduced is the digest of the whole file.
void write_reduced_data(const RunRecord& record, const std::filesystem::path& path);

/// Reads what write_local_data wrote, bit for bit. Throws ReadError with a sentence for a file
/// that is foreign, cut short, changed or of a newer format.
dem::LocalData read_local_data(const std::filesystem::path& path);
RunRecord read_run_record(const std::filesystem::path& path);

/// Hash of everything outside the group /run, 16 hexadecimal digits; of a reduced file that of the
/// whole one, since both are the same run.
std::string digest(const std::filesystem::path& path);
std::string digest(const RunRecord& record);

}  // namespace grainlaw::io
