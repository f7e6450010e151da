#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "apps/io/scene_input.h"
#include "dem/checkpoint.h"

namespace grainlaw::io {

/// A checkpoint file: the state of a run and what it belongs to.
struct StoredCheckpoint {
  dem::Checkpoint checkpoint;
  std::string scene_text;
  std::uint64_t seed = 0;
  std::string version;  ///< of the program
};

/// Where the two generations of the checkpoints of OUTPUT are: OUTPUT.checkpoint and
/// OUTPUT.checkpoint.previous.
std::filesystem::path checkpoint_path(const std::filesystem::path& output);
std::filesystem::path previous_checkpoint_path(const std::filesystem::path& output);

/// Writes a checkpoint of the run whose data go to `output`; the one before it becomes the previous
/// one. At every moment at least one of the two is complete: a damaged file never takes the place
/// of an intact one. The same state gives the same bytes: no wall time, host or date.
/// Safe to call from several threads for different outputs. Throws FileError, and leaves the older
/// checkpoints as they were.
void write_checkpoint(const dem::Checkpoint& checkpoint,
                      const SceneFile& scene,
                      const std::filesystem::path& output);

/// Reads one checkpoint file, bit for bit. Throws ReadError with a sentence for a file that is
/// foreign, cut short, changed or of a newer format.
StoredCheckpoint read_checkpoint(const std::filesystem::path& path);

/// The checkpoint to go on from.
struct NewestCheckpoint {
  std::optional<StoredCheckpoint> stored;  ///< absent: there is no checkpoint file
  std::filesystem::path path;              ///< the file it was read from
  std::string note;                        ///< why a newer file was not used; empty: there is none
};

/// The newest checkpoint of `output` that can be used. Throws ReadError when there are checkpoint
/// files but none of them can be used.
NewestCheckpoint newest_checkpoint(const std::filesystem::path& output);

/// Removes both generations: the run is finished and its data are written.
void remove_checkpoints(const std::filesystem::path& output);

}  // namespace grainlaw::io
