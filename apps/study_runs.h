#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/io/scene_input.h"
#include "apps/io/scene_text.h"
#include "dem/local_data.h"

namespace grainlaw::study {

/// Where results go and with which means.
struct Context {
  std::filesystem::path directory;
  int threads = 1;  ///< of the DEM engine
  bool quiet = false;
};

/// A DEM run of a study.
struct Run {
  std::string name;
  std::optional<dem::LocalData> data;  ///< absent: the run failed
  std::string failure;                 ///< why
  double cpu_seconds = 0.0;            ///< over all its sessions
};

/// The study was stopped by a signal or --max-wall; what is finished is kept.
struct Stopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A scene with other values, given as TOML and in the units of its file; its text says the same.
/// Throws InputError and dem::StepRefused like read_scene.
io::SceneFile changed(const io::SceneFile& scene,
                      const std::vector<io::Override>& overrides,
                      bool allow_unstable_step = false);

/// Runs the scenes one after the other, so that nothing disturbs their timing, into
/// DIR/runs/NAME.h5. Runs that are there, finished, of the same scene and the same program, are
/// taken as they are. A run whose physics fails is told in its result. Throws Stopped, FileError.
std::vector<Run> run_scenes(const std::vector<io::SceneFile>& scenes, const Context& context);

/// CPU seconds of finished and unfinished runs, in a file beside them.
class CostLog {
 public:
  explicit CostLog(std::filesystem::path path);

  bool finished(const std::string& name) const;
  double cpu_seconds(const std::string& name) const;  ///< 0: never ran
  void begin(const std::string& name);                ///< anew: what was spent before is forgotten
  void add(const std::string& name, double cpu_seconds, bool finished);

 private:
  struct Entry {
    double cpu_seconds = 0.0;
    bool finished = false;
  };
  void write() const;

  std::filesystem::path path_;
  std::map<std::string, Entry> entries_;
};

/// CPU seconds of this process so far, all its threads together.
double process_cpu_seconds();

}  // namespace grainlaw::study
