#include "apps/checkpointed_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <optional>
#include <sstream>
#include <utility>

#include "apps/io/checkpoint_hdf5.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/io/trajectory.h"
#include "apps/output_lock.h"
#include "apps/program.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// A link to an output keeps its checkpoints where the output really is.
fs::path real_output(const fs::path& output) {
  return fs::is_symlink(output) ? fs::weakly_canonical(output) : output;
}

/// The first line in which two texts differ, in words.
std::string difference(const std::string& theirs, const std::string& ours) {
  std::istringstream a(theirs);
  std::istringstream b(ours);
  std::string line_a;
  std::string line_b;
  for (int line = 1;; ++line) {
    const bool more_a = static_cast<bool>(std::getline(a, line_a));
    const bool more_b = static_cast<bool>(std::getline(b, line_b));
    if (!more_a && !more_b) return "only in the ends of their lines";
    if (!more_a) return fmt::format("the scene goes on at line {}: {}", line, line_b);
    if (!more_b) return fmt::format("the scene ends before line {}: {}", line, line_a);
    if (line_a != line_b) return fmt::format("line {} was: {}", line, line_a);
  }
}

/// Throws InputError when the checkpoint is not one of this scene and this program.
void require_same_run(const io::NewestCheckpoint& newest, const io::SceneFile& file) {
  const io::StoredCheckpoint& stored = *newest.stored;
  if (stored.version != GRAINLAW_VERSION) {
    throw io::InputError(fmt::format("{} was written by grainlaw {}, this is {}",
                                     newest.path.string(),
                                     stored.version,
                                     GRAINLAW_VERSION));
  }
  if (stored.scene_text != file.text) {
    throw io::InputError(fmt::format("{} belongs to another text of the scene than {} ({})",
                                     newest.path.string(),
                                     file.path.string(),
                                     difference(stored.scene_text, file.text)));
  }
}

/// The checkpoint to go on from; nothing stored: there is none. Says where the run goes on.
io::NewestCheckpoint checkpoint_to_resume(const io::SceneFile& file,
                                          const fs::path& output,
                                          const RunListener& listener) {
  io::NewestCheckpoint newest = io::newest_checkpoint(output);
  if (!newest.stored) return newest;
  require_same_run(newest, file);
  if (!newest.note.empty()) listener.note(newest.note);
  listener.note("goes on from " + newest.path.string());
  return newest;
}

void note_leftover(const fs::path& output, const RunListener& listener) {
  const fs::path path = io::checkpoint_path(output);
  if (!fs::exists(path)) return;
  listener.note(
      fmt::format("{} is of an unfinished run; this one starts anew and will replace it (`grainlaw "
                  "dem --resume` would go on)",
                  path.string()));
}

io::NewestCheckpoint begin(const io::SceneFile& file,
                           const fs::path& output,
                           Start start,
                           const RunListener& listener) {
  if (start == Start::anew) {
    note_leftover(output, listener);
    return {};
  }
  try {
    io::NewestCheckpoint newest = checkpoint_to_resume(file, output, listener);
    if (!newest.stored && start == Start::resume) {
      listener.note(fmt::format("no checkpoint of {}: starts from the beginning", output.string()));
    }
    return newest;
  } catch (const io::InputError& error) {
    const std::string what = error.what();
    if (start == Start::resume) throw io::InputError(what + "; without --resume it starts anew");
    listener.note(what + ": starts anew");
    return {};
  }
}

/// Writes the checkpoints of a run, and says once when that fails.
class CheckpointKeeper {
 public:
  /// `older`: the checkpoint this run goes on from; empty: none.
  CheckpointKeeper(const io::SceneFile& file,
                   const fs::path& output,
                   const fs::path& older,
                   const RunListener& listener)
      : file_(file), output_(output), listener_(listener), newest_(older) {}

  void save(const dem::Checkpoint& checkpoint) {
    try {
      io::write_checkpoint(checkpoint, file_, output_);
      newest_ = io::checkpoint_path(output_);
      failure_.clear();
    } catch (const io::FileError& error) {
      fail(error.what());
    } catch (const std::bad_alloc&) {
      fail("out of memory");
    }
  }

  /// The newest checkpoint on the path of this run; empty: there is none.
  std::string newest() const { return newest_.string(); }
  /// Why the latest one could not be written; empty: it was.
  const std::string& failure() const { return failure_; }

 private:
  void fail(const std::string& why) {
    failure_ = why;
    if (!std::exchange(said_, true)) {
      listener_.note(fmt::format("no checkpoint: {}; the run goes on{}",
                                 why,
                                 newest_.empty() ? "" : ", the checkpoint before is kept"));
    }
  }

  const io::SceneFile& file_;
  const fs::path& output_;
  const RunListener& listener_;
  fs::path newest_;
  std::string failure_;
  bool said_ = false;
};

/// Runs the engine; what it throws is completed with the checkpoint a person can turn to.
dem::LocalData run_engine(const io::SceneFile& file,
                          const dem::RunOptions& options,
                          const CheckpointKeeper& keeper) {
  try {
    return dem::run(file.scene, options);
  } catch (const dem::RunError& error) {
    if (keeper.newest().empty()) throw;
    throw dem::RunError(
        fmt::format("{}; the last checkpoint before is {}", error.what(), keeper.newest()));
  } catch (const dem::CheckpointError& error) {
    throw io::InputError(fmt::format("cannot go on from {}: {}", keeper.newest(), error.what()));
  }
}

/// Writes the data; where that fails, says what is not lost.
void write_data(const SceneRun& run,
                const io::SceneFile& file,
                const fs::path& output,
                const CheckpointKeeper& keeper) {
  try {
    io::write_local_data(run.data, file, output);
  } catch (const io::FileError& error) {
    if (keeper.newest().empty()) throw;
    throw io::FileError(
        fmt::format("{}; --resume goes on from the checkpoint {}", error.what(), keeper.newest()));
  }
}

/// A run that was asked to stop has to leave a checkpoint of where it stopped.
void require_checkpoint(const CheckpointKeeper& keeper, const fs::path& output) {
  if (keeper.failure().empty()) return;
  throw io::FileError(fmt::format(
      "stopped {}, but without a checkpoint of this moment ({}){}; what was measured so "
      "far is in {}",
      stop_reason(),
      keeper.failure(),
      keeper.newest().empty() ? "" : ", an older one is kept",
      output.string()));
}

}  // namespace

void Pace::add(const dem::Progress& now) {
  if (!begun_ || now.settling) first_ = now;
  if (now.settling) first_.steps = 0;  // steps and time are counted from the start of the flow
  begun_ = true;
  last_ = now;
}

double Pace::grain_steps_per_second() const {
  const double wall = last_.wall_seconds - first_.wall_seconds;
  if (last_.settling || wall <= 0.0) return 0.0;
  return grains_ * static_cast<double>(last_.steps - first_.steps) / wall;
}

double Pace::seconds_left() const {
  const double way = last_.time - first_.time;
  if (last_.settling || way <= 0.0) return 0.0;
  const double wall = last_.wall_seconds - first_.wall_seconds;
  return std::max(0.0, last_.expected_end - last_.time) * wall / way;
}

SceneRun run_scene(const io::SceneFile& file,
                   const fs::path& wanted_output,
                   const RunSettings& settings,
                   const RunListener& listener) {
  const fs::path output = real_output(wanted_output);
  const OutputLock lock(output);
  io::remove_temporaries(output);
  io::remove_temporaries(io::checkpoint_path(output));
  const io::NewestCheckpoint older = begin(file, output, settings.start, listener);
  CheckpointKeeper keeper(file, output, older.path, listener);
  Pace pace(dem::grains(file.scene));
  SceneRun run;
  run.resumed = older.stored.has_value();
  run.threads = settings.threads;
  bool asked_to_stop = false;
  std::optional<io::TrajectoryWriter> trajectory;
  if (settings.trajectory_interval > 0.0) {
    trajectory.emplace(output, run.resumed, io::TrajectoryWriter::Options{.xyz = settings.xyz});
  }
  dem::RunOptions options{
      .observer =
          [&](const dem::Progress& now) {
            pace.add(now);
            listener.progress(now, pace);
            asked_to_stop = stop_requested();
            return !asked_to_stop;
          },
      .threads = settings.threads,
      .save =
          [&](const dem::Checkpoint& checkpoint) {
            keeper.save(checkpoint);
            run.stopped = asked_to_stop;  // not reached where the same frame finished the run
          },
      .checkpoint_interval = settings.checkpoint_interval,
      .snapshot = {},
      .snapshot_interval = settings.trajectory_interval,
      .resume = older.stored ? &older.stored->checkpoint : nullptr,
  };
  if (trajectory) {
    options.snapshot = [&](const dem::Snapshot& snapshot) { trajectory->add(snapshot); };
  }
  run.data = run_engine(file, options, keeper);
  if (trajectory) trajectory->finish();
  run.grain_steps_per_second = pace.grain_steps_per_second();
  // One that was stopped before it moved has nothing newer than the data of before.
  const bool moved = !run.data.frames.frames.empty();
  if (moved || !run.resumed || !fs::exists(output)) write_data(run, file, output, keeper);
  if (run.stopped) require_checkpoint(keeper, output);
  if (!run.stopped) io::remove_checkpoints(output);
  return run;
}

}  // namespace grainlaw
