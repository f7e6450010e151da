#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "apps/io/scene_input.h"
#include "dem/run.h"

namespace grainlaw {

/// Where a run begins.
enum class Start {
  anew,               ///< older checkpoints of this output are replaced
  resume,             ///< go on from the newest checkpoint; one of another scene is refused
  resume_if_possible  ///< go on, or start anew where the checkpoint is of another scene or damaged
};

struct RunSettings {
  Start start = Start::anew;
  int threads = 1;
  double checkpoint_interval = 60.0;  ///< wall time between two checkpoints [s]
  double trajectory_interval = 0.0;   ///< between two snapshots of the grains [time]; 0: none
  bool xyz = false;                   ///< snapshots as extended XYZ too
};

/// How fast a run is and how long it will take, by what was seen of it since it began or went on.
class Pace {
 public:
  explicit Pace(double grains) : grains_(grains) {}
  void add(const dem::Progress& now);
  double grain_steps_per_second() const;  ///< 0 while nothing is known
  double seconds_left() const;            ///< 0 while nothing is known

 private:
  double grains_;
  bool begun_ = false;
  dem::Progress first_;  ///< when the flow started, or when it was seen first
  dem::Progress last_;
};

/// Who is told about a run.
struct RunListener {
  std::function<void(const dem::Progress&, const Pace&)> progress;
  std::function<void(const std::string&)> note;  ///< a sentence a person has to see
};

/// A run that was finished, or stopped with a checkpoint.
struct SceneRun {
  dem::LocalData data;
  bool stopped = false;  ///< by a signal or --max-wall; the newest checkpoint is where it stopped
  bool resumed = false;
  int threads = 1;
  double grain_steps_per_second = 0.0;  ///< of the mobile grains
};

/// Runs a scene, keeps checkpoints beside the output on the way, and writes its local data, also
/// those of a run that was stopped or is not steady: the window says so. The checkpoints of a
/// finished run are removed; those of a stopped or failed one stay.
///
/// A checkpoint that cannot be written (disk full) is no reason to end a run: that is noted once,
/// the older checkpoints stay, and the run goes on. Only when the run is stopped and its last
/// checkpoint could not be written, or when its data cannot be written, does it end with FileError.
///
/// Throws io::FileError, also when another program is making this output; io::InputError for
/// a checkpoint that cannot be used; dem::RunError naming the last checkpoint; what dem::run
/// throws.
SceneRun run_scene(const io::SceneFile& file,
                   const std::filesystem::path& output,
                   const RunSettings& settings,
                   const RunListener& listener);

}  // namespace grainlaw
