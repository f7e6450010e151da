#include "apps/study_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <sstream>

#include "apps/checkpointed_run.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "apps/progress.h"
#include "apps/scene_run.h"

namespace grainlaw::study {
namespace {

namespace fs = std::filesystem;

/// The data of a run that was finished before, when they are of this scene and this program.
std::optional<dem::LocalData> finished_before(const io::SceneFile& scene, const fs::path& output) {
  try {
    io::RunRecord record = io::read_run_record(output);
    if (record.scene_text == scene.text && record.version == GRAINLAW_VERSION) return record.data;
  } catch (const io::ReadError&) {  // not there, or of no use: run it
  }
  return std::nullopt;
}

std::string progress_text(const std::string& name, const dem::Progress& now, const Pace& pace) {
  if (now.settling) return name + ": packing and settling";
  return fmt::format("{}: t = {:.0f} of about {:.0f}, {} left",
                     name,
                     now.time,
                     now.expected_end,
                     duration_text(pace.seconds_left()));
}

/// CPU seconds of this session; where the ones before were killed and left no note, the wall time
/// of the whole run stands for them.
double seconds_spent(const SceneRun& run, double this_session, const CostLog& log) {
  const bool killed = run.resumed && log.cpu_seconds(run.data.name) == 0.0;
  return killed ? std::max(this_session, run.data.summary.wall_seconds) : this_session;
}

/// Runs a scene, from its checkpoint where there is one. What a run that failed cost is not kept.
Run run_one(const io::SceneFile& scene,
            const fs::path& output,
            const Context& context,
            CostLog& log,
            ProgressLine& line) {
  Run run{.name = scene.scene.name, .data = {}, .failure = {}, .cpu_seconds = 0.0};
  if (log.finished(run.name)) log.begin(run.name);  // of another scene or version
  const double start = process_cpu_seconds();
  try {
    SceneRun result = run_scene(
        scene,
        output,
        {.start = Start::resume_if_possible, .threads = context.threads},
        {.progress = [&](const dem::Progress& now,
                         const Pace& pace) { line.show(progress_text(run.name, now, pace)); },
         .note = [&](const std::string& text) { line.warn(run.name + ": " + text); }});
    if (!result.resumed) log.begin(run.name);
    log.add(run.name, seconds_spent(result, process_cpu_seconds() - start, log), !result.stopped);
    if (result.stopped) throw Stopped("stopped in " + run.name);
    run.data = std::move(result.data);
    line.report(outcome_line(*run.data));
  } catch (const dem::RunError& error) {
    run.failure = error.what();
  } catch (const dem::SceneError& error) {
    run.failure = error.what();
  }
  if (!run.data) line.report(run.name + ": failed: " + run.failure);
  run.cpu_seconds = run.data ? log.cpu_seconds(run.name) : process_cpu_seconds() - start;
  return run;
}

}  // namespace

io::SceneFile changed(const io::SceneFile& scene,
                      const std::vector<io::Override>& overrides,
                      bool allow_unstable_step) {
  return io::parse_scene(io::with_values(scene.text, overrides),
                         scene.path,
                         {.allow_unstable_step = allow_unstable_step});
}

std::vector<Run> run_scenes(const std::vector<io::SceneFile>& scenes, const Context& context) {
  const fs::path directory = context.directory / "runs";
  fs::create_directories(directory);
  CostLog log(directory / "cpu_seconds.csv");
  ProgressLine line(context.quiet);
  std::vector<Run> runs;
  for (const io::SceneFile& scene : scenes) {
    const std::string& name = scene.scene.name;
    const fs::path output = directory / (name + ".h5");
    auto kept = log.finished(name) ? finished_before(scene, output) : std::nullopt;
    if (kept) {
      line.report(name + ": kept");
      runs.push_back({name, std::move(kept), {}, log.cpu_seconds(name)});
      continue;
    }
    if (stop_requested()) throw Stopped("stopped before " + name);
    runs.push_back(run_one(scene, output, context, log, line));
  }
  return runs;
}

CostLog::CostLog(fs::path path) : path_(std::move(path)) {
  if (!fs::exists(path_)) return;
  std::istringstream lines(io::read_file(path_));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields(line);
    std::string name, seconds, finished;
    if (!std::getline(fields, name, ',') || !std::getline(fields, seconds, ',')) continue;
    std::getline(fields, finished);
    std::istringstream number(seconds);
    Entry entry;
    if (number >> entry.cpu_seconds) {
      entry.finished = finished == "finished";
      entries_[name] = entry;
    }
  }
}

bool CostLog::finished(const std::string& name) const {
  const auto found = entries_.find(name);
  return found != entries_.end() && found->second.finished;
}

double CostLog::cpu_seconds(const std::string& name) const {
  const auto found = entries_.find(name);
  return found == entries_.end() ? 0.0 : found->second.cpu_seconds;
}

void CostLog::begin(const std::string& name) {
  entries_[name] = {};
}

void CostLog::add(const std::string& name, double cpu_seconds, bool finished) {
  Entry& entry = entries_[name];
  entry.cpu_seconds += cpu_seconds;
  entry.finished = finished;
  write();
}

void CostLog::write() const {
  std::string text = "run,CPU seconds,state\n";
  for (const auto& [name, entry] : entries_) {
    text += fmt::format(
        "{},{:.10g},{}\n", name, entry.cpu_seconds, entry.finished ? "finished" : "stopped");
  }
  io::safe_write(path_, text);
}

double process_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace grainlaw::study
