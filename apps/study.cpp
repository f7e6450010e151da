#include <fmt/format.h>

#include <cmath>

#include "apps/command_line.h"
#include "apps/directory_lock.h"
#include "apps/io/study_input.h"
#include "apps/program.h"
#include "apps/progress.h"
#include "apps/scene_run.h"
#include "apps/study_kinds.h"
#include "apps/study_report.h"
#include "apps/summary.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string study;
  std::string output;
  double max_wall = 0.0;  ///< [s]; 0: no limit
};

/// Seconds of a run of a scene, from a few of its steps.
std::string time_text(const RunTime& time) {
  return fmt::format("{} to {}", duration_text(time.least), duration_text(time.most));
}

ExitCode check(const io::StudyFile& file, const CommonOptions& options) {
  const study::Plan plan =
      std::visit([](const auto& kind) { return study::plan(kind); }, file.kind);
  Summary summary;
  summary.add("title", "study", file.title);
  summary.add("kind", "kind", std::string(kind_name(file)));
  RunTime total;
  for (const io::SceneFile& scene : plan.scenes) {
    const RunTime time = run_time(scene.scene);
    total.least += time.least;
    total.most += time.most;
    summary.add(scene.scene.name, "DEM run " + scene.scene.name, time_text(time));
  }
  if (!plan.other.empty()) summary.add("other", "also", plan.other);
  if (!plan.scenes.empty()) {
    summary.add("seconds_least", "all of them, at least", std::round(total.least), "s");
    summary.add("seconds_most", "all of them, at most", std::round(total.most), "s");
  }
  print(summary, options);
  return ExitCode::answered;
}

Summary summarise(const study::Result& result, const fs::path& directory) {
  Summary summary;
  summary.add("title", "study", result.title);
  summary.add("kind", "kind", result.kind);
  summary.add("machine", "machine", result.machine);
  summary.add("reference", "errors against", result.reference);
  if (!result.remarks.empty()) summary.add("remarks", "remarks", result.remarks);
  for (const char* name : {"study.csv", "study.svg", "study.html", "study.md"}) {
    if (fs::exists(directory / name)) summary.add(name, name, (directory / name).string());
  }
  summary.add("advice", "what to choose", result.advice);
  return summary;
}

ExitCode study_errors(Arguments arguments, const CommonOptions& options) {
  const io::StudyFile file = io::read_study(arguments.study);
  if (options.check) return check(file, options);
  if (arguments.output.empty()) arguments.output = file.path.stem().string() + "-study";
  const fs::path directory = arguments.output;
  const DirectoryLock lock(directory);
  catch_stop_signals(arguments.max_wall);
  const study::Context context{
      .directory = directory, .threads = options.threads, .quiet = options.quiet};
  try {
    study::Result result =
        std::visit([&](const auto& kind) { return study::run(kind, file, context); }, file.kind);
    result.title = file.title;
    result.kind = kind_name(file);
    result.machine = fmt::format("{}, {} of them used", machine(), options.threads);
    const std::string missing = study::write_report(result, directory);
    if (!missing.empty()) say("warning: study.svg was not drawn: " + missing);
    print(summarise(result, directory), options);
  } catch (const study::Stopped& stopped) {
    say(fmt::format("grainlaw study: {} {}; the same command goes on with the runs in {}",
                    stopped.what(),
                    stop_reason(),
                    (directory / "runs").string()));
    return ExitCode::stopped;
  }
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommandLine line("study",
                   "Error against run time: sweeps time step, number of grains, base, averaging\n"
                   "time, kernel, solver or law, or goes the whole way, and says what to choose.",
                   "  grainlaw study data/studies/solver.toml -o solver-study\n"
                   "  grainlaw study data/studies/time_step.toml -o step-study --check");
  Arguments arguments;
  line.required("STUDY.toml", arguments.study, "the study");
  line.option("-o,--output", arguments.output, "folder for results (default: STUDY-study)");
  line.duration("--max-wall", arguments.max_wall, "stop with a checkpoint after this wall time");
  line.threads("of the DEM engine (default: 1)", 1);
  return line.run(
      argc, argv, [&](const CommonOptions& options) { return study_errors(arguments, options); });
}
