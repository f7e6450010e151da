#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <thread>

#include "apps/checkpointed_run.h"
#include "apps/command_line.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/program.h"
#include "apps/progress.h"
#include "apps/run_plot.h"
#include "apps/scene_run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string scene;
  std::string output;
  bool allow_step = false;
  bool resume = false;
  bool reduce = false;
  double max_wall = 0.0;              ///< [s]; 0: no limit
  double checkpoint_interval = 60.0;  ///< [s]
  std::string trajectory;             ///< time between two snapshots; empty: none
  std::string export_format;
  std::string plot;  ///< picture of the profiles; empty: none
};

std::string progress_text(const dem::Progress& now, const Pace& pace) {
  if (now.settling) return "packing and settling";
  std::string text = fmt::format("t = {:.0f} of about {:.0f}, mean velocity {:.2f}",
                                 now.time,
                                 now.expected_end,
                                 now.mean_velocity);
  const double rate = pace.grain_steps_per_second();
  if (rate <= 0.0) return text;
  return text + fmt::format(", {:.3g} M grain-steps/s, {} left",
                            rate / 1e6,
                            duration_text(pace.seconds_left()));
}

/// Threads beyond the cores would only wait for each other; the result is the same with any number.
int usable_threads(int asked) {
  const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  if (asked <= cores) return asked;
  say(fmt::format("--threads {}: this machine has {} cores, {} are used", asked, cores, cores));
  return cores;
}

/// Time between two snapshots of the grains; 0: none.
double trajectory_interval(const Arguments& arguments) {
  if (!arguments.export_format.empty() && arguments.export_format != "xyz") {
    throw io::InputError("--export " + arguments.export_format + ": known: xyz");
  }
  if (arguments.trajectory.empty()) {
    if (arguments.export_format.empty()) return 0.0;
    throw io::InputError("--export needs --trajectory, the time between two snapshots");
  }
  const std::string& text = arguments.trajectory;
  constexpr double least = 1e-9;  // far below any sample; multiples of it can still be counted
  double interval = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), interval);
  if (error == std::errc() && end == text.data() + text.size() && interval >= least)
    return interval;
  throw io::InputError(
      fmt::format("--trajectory {}: a time of at least {} is expected, in sqrt(d/g)", text, least));
}

std::string resume_command(const Arguments& arguments) {
  std::string more = arguments.allow_step ? " --allow-step" : "";
  if (!arguments.trajectory.empty()) more += " --trajectory " + arguments.trajectory;
  if (!arguments.export_format.empty()) more += " --export " + arguments.export_format;
  if (!arguments.plot.empty()) more += " --plot " + arguments.plot;
  return fmt::format("grainlaw dem {} -o {}{} --resume", arguments.scene, arguments.output, more);
}

SceneRun run_with_progress(const io::SceneFile& file,
                           const Arguments& arguments,
                           const CommonOptions& options) {
  ProgressLine line(options.quiet);
  return run_scene(file,
                   arguments.output,
                   {.start = arguments.resume ? Start::resume : Start::anew,
                    .threads = usable_threads(options.threads),
                    .checkpoint_interval = arguments.checkpoint_interval,
                    .trajectory_interval = trajectory_interval(arguments),
                    .xyz = !arguments.export_format.empty()},
                   {.progress = [&](const dem::Progress& now,
                                    const Pace& pace) { line.show(progress_text(now, pace)); },
                    .note = [&](const std::string& text) { line.warn("grainlaw dem: " + text); }});
}

Summary summarise(const SceneRun& run, const std::string& output) {
  Summary summary = describe(run.data);
  summary.add("grain_steps_per_second", "grain steps per second", run.grain_steps_per_second);
  summary.add("threads", "threads", static_cast<long>(run.threads));
  summary.add("resumed", "went on from a checkpoint", run.resumed);
  summary.add("output", "local data", output);
  summary.add("digest", "digest of all but /run", io::digest(output));
  return summary;
}

/// Before a long run: can it be drawn and written at the end?
void require_picture(const Arguments& arguments) {
  refuse_overwriting_input(arguments.plot, {arguments.scene, arguments.output});
  require_plottable(arguments.plot);
  require_writable(arguments.plot);
}

/// A run without rows has nothing to draw; its answer says why.
void plot_if_measured(const dem::LocalData& data, const std::string& picture) {
  if (data.rows.empty()) {
    say("grainlaw dem: no layer was measured, " + picture + " is not drawn");
  } else {
    plot(data, picture);
  }
}

/// A finished run with its frames joined: for keeping, sending, fitting anew.
ExitCode reduce(const Arguments& arguments, const CommonOptions& options) {
  if (arguments.resume || !arguments.trajectory.empty() || !arguments.plot.empty()) {
    throw io::InputError("--reduce runs and draws nothing: leave out the other options but -o");
  }
  std::string output = arguments.output;
  if (output.empty()) output = fs::path(arguments.scene).stem().string() + "_reduced.h5";
  refuse_overwriting_input(output, {arguments.scene});
  require_writable(output);
  const io::RunRecord whole = io::read_run_record(arguments.scene);
  io::write_reduced_data(whole, output);
  const io::RunRecord small = io::read_run_record(output);
  Summary summary = describe(small.data);
  const auto add_size = [&](const char* key, const char* label, const std::string& path) {
    summary.add(key, label, static_cast<double>(fs::file_size(path)) / 1e6, "MB");
  };
  add_size("size", "size", output);
  add_size("size_before", "  before", arguments.scene);
  summary.add("output", "local data", output);
  summary.add("digest", "digest of the whole file", io::digest(small));
  print(summary, options);
  return ExitCode::answered;
}

ExitCode run(Arguments arguments, const CommonOptions& options) {
  if (arguments.reduce) return reduce(arguments, options);
  const io::SceneFile file =
      io::read_scene(arguments.scene, {.allow_unstable_step = arguments.allow_step});
  if (options.check) {
    print(check_scene(file, run_time(file.scene)), options);
    return ExitCode::answered;
  }
  std::string& output = arguments.output;
  if (output.empty()) output = fs::path(arguments.scene).stem().string() + ".h5";
  refuse_overwriting_input(output, {arguments.scene});
  trajectory_interval(arguments);
  require_writable(output);  // now, not after a long run
  if (!arguments.plot.empty()) require_picture(arguments);
  catch_stop_signals(arguments.max_wall);
  const SceneRun result = run_with_progress(file, arguments, options);
  print(summarise(result, output), options);
  if (!arguments.plot.empty()) plot_if_measured(result.data, arguments.plot);
  if (result.stopped) {
    say(fmt::format("grainlaw dem: stopped {}; what was measured so far is in {}; to go on:\n  {}",
                    stop_reason(),
                    output,
                    resume_command(arguments)));
    return ExitCode::stopped;
  }
  const bool time_run = !result.data.conditions.tilts.empty();
  if (time_run && result.data.window.arrested_at) return ExitCode::answered;
  if (!result.data.window.steady) {
    throw NoAnswer("no steady state: " + result.data.window.reason);
  }
  if (result.data.rows.empty()) {
    throw NoAnswer("steady, but no layer has grains enough, or touching ones, for local data");
  }
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommandLine line("dem",
                   "Runs one DEM scene and writes local data with standard errors. Checkpoints\n"
                   "are kept beside them until the run is finished.",
                   "  grainlaw dem data/scenes/chute.toml -o chute.h5\n"
                   "  grainlaw dem data/scenes/chute.toml -o chute.h5 --max-wall 2h --resume\n"
                   "  grainlaw dem chute.h5 --reduce -o small.h5");
  Arguments arguments;
  line.required("SCENE.toml", arguments.scene, "the scene; with --reduce a finished run (.h5)");
  line.flag("--allow-step", arguments.allow_step, "accept a time step above the stability limit");
  line.option("-o,--output", arguments.output, "local data file (default: scene name + .h5)");
  line.flag("--resume", arguments.resume, "go on from the newest checkpoint of this output");
  line.flag("--reduce", arguments.reduce, "write a finished run again, frames joined: smaller");
  line.duration("--max-wall", arguments.max_wall, "stop with a checkpoint after this wall time");
  line.duration("--checkpoint-interval",
                arguments.checkpoint_interval,
                "wall time between two checkpoints (default: 60s)");
  line.option(
      "--trajectory", arguments.trajectory, "grains every so often [sqrt(d/g)], for ParaView");
  line.option("--export", arguments.export_format, "xyz: as extended XYZ too, for OVITO");
  line.option("--plot", arguments.plot, "draw the profiles too, as FILE.svg or FILE.png");
  line.threads("of the engine (default: 1)", 1);
  return line.run(
      argc, argv, [&](const CommonOptions& options) { return run(arguments, options); });
}
