#include "apps/campaign_run.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <cstring>
#include <list>
#include <new>

#include "apps/campaign_progress.h"
#include "apps/checkpointed_run.h"
#include "apps/child_process.h"
#include "apps/exit_code.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/scene_run.h"
#include "dem/flow_setup.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

/// First letter of the messages of a child.
constexpr char progress_message = 'p';
constexpr char note_message = 'n';
constexpr char failure_message = 'f';

/// Data of a run that was stopped look like those of one that was not.
bool complete(const dem::LocalData& data, const dem::Scene& scene) {
  const auto& frames = data.frames.frames;
  if (frames.empty()) return false;
  return frames.back().end >= scene.measurement.time_limit ||
         dem::assess(frames, dem::steady_criteria(scene)).certain;
}

/// The file, out of the way under its own name in another folder.
void move_to(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) return;
  fs::create_directories(folder, error);
  fs::rename(file, folder / file.filename(), error);
  if (error) {
    throw io::FileError(
        fmt::format("cannot move {} to {}: {}", file.string(), folder.string(), error.message()));
  }
}

/// The data of this very run, where they are complete. What another scene or version made is moved
/// aside; a broken file is left to be replaced.
std::optional<dem::LocalData> finished_before(const io::SceneFile& file,
                                              const fs::path& output,
                                              ProgressBoard& board) {
  if (!fs::exists(output)) return std::nullopt;
  try {
    io::RunRecord record = io::read_run_record(output);
    if (record.scene_text == file.text && record.version == GRAINLAW_VERSION) {
      if (!complete(record.data, file.scene)) return std::nullopt;
      return std::move(record.data);
    }
  } catch (const io::ReadError& error) {
    board.note(fmt::format("{}; the run is made anew", error.what()));
    return std::nullopt;
  }
  const fs::path aside = output.parent_path() / "replaced";
  move_to(aside, output);
  board.note(fmt::format("{} is of another scene text or version and was moved to {}",
                         output.string(),
                         aside.string()));
  return std::nullopt;
}

/// A finished run: what an earlier try left as failed is no longer true.
void forget_failure(const fs::path& directory, const std::string& name) {
  for (const char* ending : {".txt", ".toml", ".h5", ".h5.checkpoint", ".h5.checkpoint.previous"}) {
    std::error_code ignored;
    fs::remove(directory / "failed" / (name + ending), ignored);
  }
}

void set_failed_aside(const fs::path& directory,
                      const io::SceneFile& file,
                      const std::string& why) {
  const fs::path failed = directory / "failed";
  const std::string output = data_path(directory, file.scene.name).string();
  for (const char* ending : {"", ".checkpoint", ".checkpoint.previous"}) {
    move_to(failed, output + ending);
  }
  io::remove_temporaries(output);
  std::error_code ignored;
  fs::remove(output + ".lock", ignored);  // a run that crashed leaves it
  fs::create_directories(failed);
  io::safe_write(scene_path(failed, file.scene.name), file.text);
  io::safe_write(failed / (file.scene.name + ".txt"), why + "\n");
}

/// The life of a child: one scene. What is wrong goes to the parent as a message.
int run_in_child(const io::SceneFile& file,
                 const fs::path& output,
                 const ChildProcess::Send& send) {
  const RunListener listener{.progress =
                                 [&](const dem::Progress& now, const Pace& pace) {
                                   send(progress_message + run_progress(now, pace).text());
                                 },
                             .note = [&](const std::string& text) { send(note_message + text); }};
  ExitCode code = ExitCode::no_answer;
  std::string failure;
  try {
    const SceneRun run = run_scene(file, output, {.start = Start::resume_if_possible}, listener);
    return static_cast<int>(run.stopped ? ExitCode::stopped : ExitCode::answered);
  } catch (const io::FileError& error) {
    code = ExitCode::resource;
    failure = error.what();
  } catch (const std::bad_alloc&) {  // its own: others may be smaller
    failure = "out of memory";
  } catch (const std::exception& error) {
    failure = error.what();
  }
  send(failure_message + failure);
  return static_cast<int>(code);
}

/// A run that is being made.
struct RunningScene {
  std::size_t index;
  std::string failure;  ///< as the child tells it
  ChildProcess child;

  RunningScene(std::size_t which, const io::SceneFile& file, const fs::path& output)
      : index(which),
        child([&](const ChildProcess::Send& send) { return run_in_child(file, output, send); }) {}
};

std::string reason(const ChildProcess::Ending& ending, const std::string& told) {
  if (ending.signal != 0) {
    return fmt::format(
        "its process was ended by signal {} ({})", ending.signal, ::strsignal(ending.signal));
  }
  return told.empty() ? fmt::format("its process ended with code {}", ending.code) : told;
}

/// All runs of a campaign, some at a time.
class Runs {
 public:
  Runs(const std::vector<io::SceneFile>& scenes,
       const fs::path& directory,
       int processes,
       ProgressBoard& board)
      : scenes_(scenes),
        directory_(directory),
        processes_(static_cast<std::size_t>(processes)),
        board_(board) {
    for (const io::SceneFile& file : scenes) {
      results_.push_back(
          {.name = file.scene.name, .data = {}, .failure = "not started", .cpu_seconds = 0.0});
    }
  }

  std::vector<CampaignRun> all() {
    while (true) {
      if (stopping() && !std::exchange(asked_to_stop_, true)) ask_to_stop();
      while (!stopping() && running_.size() < processes_ && next_ < scenes_.size()) start();
      if (running_.empty()) break;
      wait_for_messages();
    }
    if (!resource_failure_.empty()) throw io::FileError(resource_failure_);
    return std::move(results_);
  }

 private:
  bool stopping() const { return stop_requested() || !resource_failure_.empty(); }

  void ask_to_stop() {
    if (!running_.empty()) board_.note("stopping: runs write their checkpoints");
    for (const RunningScene& run : running_) run.child.ask_to_stop();
  }

  void start() {
    const std::size_t k = next_++;
    const fs::path output = data_path(directory_, results_[k].name);
    results_[k].data = finished_before(scenes_[k], output, board_);
    if (results_[k].data) {
      results_[k].kept = true;
      board_.finish(k, "");
      return;
    }
    running_.emplace_back(k, scenes_[k], output);
  }

  void wait_for_messages() {
    std::vector<pollfd> pipes;
    for (const RunningScene& run : running_) pipes.push_back({run.child.descriptor(), POLLIN, 0});
    constexpr int patience = 500;  // [ms], to see that --max-wall is over
    if (::poll(pipes.data(), pipes.size(), patience) <= 0) return;
    auto run = running_.begin();
    for (const pollfd& pipe : pipes) {
      if (pipe.revents != 0) listen(*run);
      run = run->child.ended() ? (end(*run), running_.erase(run)) : std::next(run);
    }
  }

  void listen(RunningScene& run) {
    for (const std::string& message : run.child.receive()) {
      const std::string words = message.substr(1);
      if (message[0] == failure_message) run.failure = words;
      if (message[0] == note_message) board_.note(results_[run.index].name + ": " + words);
      if (message[0] != progress_message) continue;
      if (const auto now = RunProgress::parse(words)) board_.update(run.index, *now);
    }
  }

  void end(RunningScene& run) {
    const ChildProcess::Ending ending = run.child.wait();
    CampaignRun& result = results_[run.index];
    result.cpu_seconds = ending.cpu_seconds;
    result.failure = reason(ending, run.failure);
    const auto code = static_cast<ExitCode>(ending.code);
    if (code == ExitCode::answered) {
      result.data = io::read_local_data(data_path(directory_, result.name));
      forget_failure(directory_, result.name);
    } else if (code == ExitCode::stopped) {
      result.failure = "it was stopped; the same command goes on with it";
    } else if (code == ExitCode::resource) {
      resource_failure_ = result.failure;
    } else {
      set_failed_aside(directory_, scenes_[run.index], result.failure);
    }
    board_.finish(run.index,
                  result.data ? outcome_line(*result.data) : result.name + ": " + result.failure);
  }

  const std::vector<io::SceneFile>& scenes_;
  const fs::path& directory_;
  std::size_t processes_;
  ProgressBoard& board_;
  std::vector<CampaignRun> results_;
  std::list<RunningScene> running_;
  std::size_t next_ = 0;
  bool asked_to_stop_ = false;
  std::string resource_failure_;  ///< of disk: no run can go on
};

}  // namespace

fs::path scene_path(const fs::path& directory, const std::string& name) {
  return directory / (name + ".toml");
}

fs::path data_path(const fs::path& directory, const std::string& name) {
  return directory / (name + ".h5");
}

void write_scenes(const std::vector<io::SceneFile>& scenes, const fs::path& directory) {
  for (const io::SceneFile& file : scenes) {
    io::safe_write(scene_path(directory, file.scene.name), file.text);
  }
}

std::vector<CampaignRun> run_scenes(const std::vector<io::SceneFile>& scenes,
                                    const fs::path& directory,
                                    int processes,
                                    ProgressLine& progress) {
  write_scenes(scenes, directory);
  ProgressBoard board(scenes.size(), processes, progress);
  return Runs(scenes, directory, processes, board).all();
}

}  // namespace grainlaw
