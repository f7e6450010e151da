#include "apps/campaign_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <exception>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "apps/checkpointed_run.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/scene_run.h"

namespace grainlaw {
namespace {

double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Share of a run that is done, 0 to 1.
double share_done(const dem::Progress& now) {
  if (now.settling || now.expected_end <= 0.0) return 0.0;
  return std::clamp(now.time / now.expected_end, 0.0, 1.0);
}

/// The names of the runs that are finished, in a file that is there only while the campaign is not:
/// one that was interrupted goes on where it was. May be used from several threads.
class CampaignLog {
 public:
  explicit CampaignLog(const std::filesystem::path& directory) : path_(directory / "unfinished") {
    interrupted_ = std::filesystem::exists(path_);
    if (!interrupted_) io::safe_write(path_, "");
    std::istringstream lines(io::read_file(path_));
    for (std::string name; std::getline(lines, name);) finished_.insert(name);
  }

  bool interrupted() const { return interrupted_; }
  bool finished(const std::string& name) {
    const std::lock_guard lock(mutex_);
    return finished_.contains(name);
  }
  void add(const std::string& name) {
    const std::lock_guard lock(mutex_);
    finished_.insert(name);
    std::string text;
    for (const std::string& one : finished_) text += one + '\n';
    io::safe_write(path_, text);
  }
  void remove() { std::filesystem::remove(path_); }

 private:
  std::mutex mutex_;
  std::filesystem::path path_;
  std::set<std::string> finished_;
  bool interrupted_ = false;
};

/// Progress of all runs together, in one line.
class ProgressBoard {
 public:
  ProgressBoard(std::size_t runs, int threads, ProgressLine& line)
      : share_(runs, 0.0), seconds_(runs, 0.0), left_(runs, 0.0), threads_(threads), line_(line) {}

  void update(std::size_t run, const dem::Progress& now, const Pace& pace) {
    const std::lock_guard lock(mutex_);
    share_[run] = share_done(now);
    left_[run] = pace.seconds_left();
    seconds_[run] = now.wall_seconds + left_[run];
    line_.show(text());
  }
  void note(const std::string& text) { line_.warn(text); }
  void finish(std::size_t run, const std::string& outcome) {
    const std::lock_guard lock(mutex_);
    share_[run] = 1.0;
    left_[run] = 0.0;
    line_.report(outcome);
  }

 private:
  /// Runs that have not begun are expected to take as long as those that have.
  double seconds_left_for_all() const {
    double known = 0.0;
    int begun = 0;
    for (const double seconds : seconds_) {
      known += seconds;
      if (seconds > 0.0) ++begun;
    }
    const double typical = begun > 0 ? known / begun : 0.0;
    double left = 0.0;
    for (std::size_t k = 0; k < share_.size(); ++k) {
      left += share_[k] == 0.0 ? typical : left_[k];
    }
    return left / std::min<double>(threads_, static_cast<double>(share_.size()));
  }

  std::string text() const {
    const auto done = std::count(share_.begin(), share_.end(), 1.0);
    std::string out = fmt::format("DEM: {} of {} runs done", done, share_.size());
    for (std::size_t k = 0; k < share_.size(); ++k) {
      if (share_[k] > 0.0 && share_[k] < 1.0) {
        out += fmt::format(", run {} {:.0f} %", k + 1, 100.0 * share_[k]);
      }
    }
    return out + fmt::format(", about {} left", duration_text(seconds_left_for_all()));
  }

  std::mutex mutex_;
  std::vector<double> share_;
  std::vector<double> seconds_;  ///< expected wall time of each run
  std::vector<double> left_;     ///< of it
  int threads_;
  ProgressLine& line_;
};

/// The data of a run that was finished before the campaign was interrupted, when they are of this
/// scene and this program.
std::optional<dem::LocalData> finished_before(const io::SceneFile& file,
                                              const std::filesystem::path& output) {
  try {
    io::RunRecord record = io::read_run_record(output);
    if (record.scene_text == file.text && record.version == GRAINLAW_VERSION) return record.data;
  } catch (const io::ReadError&) {  // run it again
  }
  return std::nullopt;
}

CampaignRun run_one(const io::SceneFile& file,
                    const std::filesystem::path& output,
                    CampaignLog& log,
                    const RunListener& listener) {
  CampaignRun result;
  result.name = file.scene.name;
  if (log.finished(result.name)) result.data = finished_before(file, output);
  if (result.data) return result;
  const double start = thread_cpu_seconds();
  try {
    const Start from = log.interrupted() ? Start::resume_if_possible : Start::anew;
    SceneRun run = run_scene(file, output, {.start = from}, listener);
    if (!run.stopped) log.add(result.name);
    result.data = std::move(run.data);
  } catch (const dem::RunError& error) {
    result.failure = error.what();
  } catch (const dem::SceneError& error) {
    result.failure = error.what();
  }
  result.cpu_seconds = thread_cpu_seconds() - start;
  return result;
}

}  // namespace

std::vector<CampaignRun> run_scenes(const std::vector<io::SceneFile>& scenes,
                                    const std::filesystem::path& directory,
                                    int threads,
                                    ProgressLine& progress) {
  std::vector<CampaignRun> results(scenes.size(),
                                   {.name = {}, .data = {}, .failure = "not started"});
  ProgressBoard board(scenes.size(), threads, progress);
  CampaignLog log(directory);
  std::atomic<std::size_t> next = 0;
  std::mutex failure_mutex;
  std::exception_ptr failure;  // of disk or memory: no run can go on
  const auto run = [&](std::size_t k) {
    try {
      const std::string& name = scenes[k].scene.name;
      const RunListener listener{
          .progress = [&](const dem::Progress& now,
                          const Pace& pace) { board.update(k, now, pace); },
          .note = [&](const std::string& text) { board.note(name + ": " + text); }};
      results[k] = run_one(scenes[k], directory / (name + ".h5"), log, listener);
      board.finish(k,
                   results[k].data ? outcome_line(*results[k].data)
                                   : results[k].name + ": failed: " + results[k].failure);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      failure = std::current_exception();
      next = scenes.size();
    }
  };
  const auto work = [&] {
    for (std::size_t k = next++; k < scenes.size() && !stop_requested(); k = next++) run(k);
  };
  std::vector<std::jthread> workers;
  const auto count = std::min<std::size_t>(static_cast<std::size_t>(threads), scenes.size());
  for (std::size_t k = 0; k < count; ++k) workers.emplace_back(work);
  workers.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  if (!stop_requested()) log.remove();
  return results;
}

}  // namespace grainlaw
