#include <fmt/core.h>

#include <filesystem>

#include "apps/command_line.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/program.h"
#include "apps/progress.h"
#include "apps/scene_run.h"

namespace grainlaw {
namespace {

std::string progress_text(const dem::Progress& now) {
  if (now.settling) return "packing and settling";
  return fmt::format("t = {:.0f} of about {:.0f}, mean velocity {:.2f}, {:.0f} steps/s, {} left",
                     now.time,
                     now.expected_end,
                     now.mean_velocity,
                     static_cast<double>(now.steps) / now.wall_seconds,
                     duration_text(seconds_left(now)));
}

ExitCode run(const std::string& scene_path,
             std::string output,
             bool allow_step,
             const CommonOptions& options) {
  const io::SceneFile file = io::read_scene(scene_path, {.allow_unstable_step = allow_step});
  if (options.check) {
    print(check_scene(file), options);
    return ExitCode::answered;
  }
  if (output.empty()) output = std::filesystem::path(scene_path).stem().string() + ".h5";
  refuse_overwriting_input(output, {scene_path});
  require_writable(output);  // now, not after a long run
  catch_stop_signals();
  ProgressLine progress(options.quiet);
  const dem::LocalData data =
      run_scene(file, output, [&](const dem::Progress& now) { progress.show(progress_text(now)); });
  Summary summary = describe(data);
  summary.add("output", "local data", output);
  summary.add("digest", "digest of all but /run", io::digest(output));
  print(summary, options);
  if (stop_requested()) {
    say("grainlaw dem: stopped; what was measured so far is in " + output);
    return ExitCode::stopped;
  }
  if (!data.window.steady) throw NoAnswer("no steady state: " + data.window.reason);
  return ExitCode::answered;
}

}  // namespace
}  // namespace grainlaw

int main(int argc, char** argv) {
  using namespace grainlaw;
  CommonOptions options;
  CommandLine line("grainlaw-dem",
                   "Runs one DEM scene and writes local data with standard errors.\n"
                   "One scene runs on one thread; campaigns run several scenes at once.",
                   "  grainlaw dem data/scenes/chute.toml -o chute.h5",
                   options);
  std::string scene;
  std::string output;
  bool allow_step = false;
  line.required("SCENE.toml", scene, "the scene");
  line.flag("--allow-step", allow_step, "accept a time step above the stability limit");
  line.option("-o,--output", output, "local data file (default: name of the scene + .h5)");
  if (const auto code = line.parse(argc, argv)) return *code;
  return run_program("grainlaw dem", [&] { return run(scene, output, allow_step, options); });
}
