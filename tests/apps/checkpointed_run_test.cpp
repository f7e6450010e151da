#include "apps/checkpointed_run.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "apps/io/local_data_hdf5.h"
#include "apps/program.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw {
namespace {

dem::Progress flowing(double time, long steps, double wall_seconds) {
  return {.time = time, .expected_end = 100.0, .steps = steps, .wall_seconds = wall_seconds};
}

TEST(Pace, CountsFromTheStartOfTheFlowNotFromThePacking) {
  Pace pace(1000.0);
  dem::Progress settling;
  settling.steps = 5000;
  settling.wall_seconds = 8.0;
  settling.settling = true;
  pace.add(settling);
  EXPECT_EQ(pace.grain_steps_per_second(), 0.0);
  pace.add(flowing(25.0, 2000, 10.0));
  EXPECT_DOUBLE_EQ(pace.grain_steps_per_second(), 1000.0 * 2000.0 / 2.0);
  EXPECT_DOUBLE_EQ(pace.seconds_left(), 75.0 / 25.0 * 2.0);
}

TEST(Pace, CountsOnlyWhatWasDoneSinceARunWentOn) {
  Pace pace(1000.0);
  pace.add(flowing(50.0, 4000, 1.0));  // nearly all of it before the interruption
  EXPECT_EQ(pace.grain_steps_per_second(), 0.0);
  EXPECT_EQ(pace.seconds_left(), 0.0);
  pace.add(flowing(60.0, 4800, 3.0));
  EXPECT_DOUBLE_EQ(pace.grain_steps_per_second(), 1000.0 * 800.0 / 2.0);
  EXPECT_DOUBLE_EQ(pace.seconds_left(), 40.0 / 10.0 * 2.0);
}

/// A layer that accelerates, run for 20 sqrt(d/g), asked to stop once it has come this far.
struct StoppedAt {
  explicit StoppedAt(double time) {
    const auto ask = [&](const dem::Progress& now, const Pace&) {
      if (!now.settling && now.time >= time) stop_after(0.0);
      last = now.time;
    };
    run = run_scene(file, output, {}, {.progress = ask, .note = [](const std::string&) {}});
    stop_after(1e9);
  }
  SceneRun resumed_and_stopped_at_once() const {
    stop_after(0.0);
    const auto ignore = [](const auto&...) {};
    SceneRun again = run_scene(file, output, {.start = Start::resume}, {ignore, ignore});
    stop_after(1e9);
    return again;
  }
  bool has_checkpoint() const { return std::filesystem::exists(output.string() + ".checkpoint"); }

  io::SceneFile file = io::parse_scene(
      "units = \"grain\"\n"
      "[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e3\nrestitution = 0.5\n"
      "[geometry]\nkind = \"chute\"\ninclination = 30\n"
      "length = 4\nwidth = 4\ngrains = 60\n"
      "[measurement]\naveraging_time = 10\ntime_limit = 20\n",
      "small.toml");
  io::TemporaryDirectory directory;
  std::filesystem::path output = directory.path() / "small.h5";
  double last = 0.0;
  SceneRun run;
};

TEST(CheckpointedRun, StoppedOnItsWayLeavesACheckpoint) {
  const StoppedAt early(4.0);
  EXPECT_TRUE(early.run.stopped);
  EXPECT_TRUE(early.has_checkpoint());
}

TEST(CheckpointedRun, StoppedBeforeItMovesOnKeepsItsDataAndCheckpoint) {
  const StoppedAt early(4.0);
  const SceneRun again = early.resumed_and_stopped_at_once();
  EXPECT_TRUE(again.stopped);
  EXPECT_TRUE(again.data.frames.frames.empty());
  EXPECT_TRUE(early.has_checkpoint());
  EXPECT_EQ(io::read_local_data(early.output).frames.frames.size(),
            early.run.data.frames.frames.size());
}

TEST(CheckpointedRun, AskedToStopInItsLastFrameIsFinished) {
  const StoppedAt never(std::numeric_limits<double>::infinity());
  const StoppedAt at_end(never.last);
  EXPECT_EQ(at_end.last, never.last);
  EXPECT_FALSE(at_end.run.stopped);
  EXPECT_FALSE(at_end.has_checkpoint());
}

}  // namespace
}  // namespace grainlaw
