#include "apps/campaign_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <exception>
#include <mutex>
#include <thread>

#include "apps/program.h"
#include "apps/scene_run.h"

namespace grainlaw {
namespace {

double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Progress of all runs together, in one line.
class ProgressBoard {
 public:
  ProgressBoard(std::size_t runs, int threads, ProgressLine& line)
      : share_(runs, 0.0), seconds_(runs, 0.0), threads_(threads), line_(line) {}

  void update(std::size_t run, const dem::Progress& now) {
    const std::lock_guard lock(mutex_);
    share_[run] = share_done(now);
    seconds_[run] = now.wall_seconds + seconds_left(now);
    line_.show(text());
  }
  void finish(std::size_t run, const std::string& outcome) {
    const std::lock_guard lock(mutex_);
    share_[run] = 1.0;
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
      left += (1.0 - share_[k]) * (seconds_[k] > 0.0 ? seconds_[k] : typical);
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
  int threads_;
  ProgressLine& line_;
};

CampaignRun run_one(const io::SceneFile& file,
                    const std::filesystem::path& directory,
                    const ShowProgress& show) {
  CampaignRun result;
  result.name = file.scene.name;
  const double start = thread_cpu_seconds();
  try {
    result.data = run_scene(file, directory / (file.scene.name + ".h5"), show);
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
  std::atomic<std::size_t> next = 0;
  std::mutex failure_mutex;
  std::exception_ptr failure;  // of disk or memory: no run can go on
  const auto run = [&](std::size_t k) {
    try {
      results[k] =
          run_one(scenes[k], directory, [&](const dem::Progress& now) { board.update(k, now); });
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
  return results;
}

}  // namespace grainlaw
