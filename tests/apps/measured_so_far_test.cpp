#include "apps/measured_so_far.h"

#include <gtest/gtest.h>

#include "apps/checkpointed_run.h"
#include "apps/io/checkpoint_hdf5.h"
#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/program.h"
#include "dem/flow_setup.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw {
namespace {

/// Soft grains sheared at I = 0.1 and p* = 0.01 for 30 strains, stopped after 6: the start, a
/// strain of 1, is over, and the 20 strains to average over are not.
struct StoppedBox {
  StoppedBox() {
    const auto ask = [&](const dem::Progress& now, const Pace&) {
      if (now.time > 6.0 * strain) stop_after(0.0);
    };
    run_scene(file, output, {}, {.progress = ask, .note = [](const std::string&) {}});
    stop_after(1e9);
  }

  static constexpr double strain = 100.0;  ///< [time], of one strain
  io::SceneFile file = io::parse_scene(
      "units = \"stiffness\"\n"
      "[contact.normal]\nlaw = \"hooke\"\ndashpot = 0.1\n"
      "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
      "[geometry]\nkind = \"simple_shear\"\nshear_rate = 0.01\npressure = 0.01\ngrains = 100\n"
      "[measurement]\nsample_interval = 0.5\nframe_interval = 10\n"
      "averaging_time = 2000\ntime_limit = 3000\n",
      "box.toml");
  io::TemporaryDirectory directory;
  std::filesystem::path output = directory.path() / "box.h5";
};

TEST(MeasuredSoFar, ARunThatWasStoppedCountsWhereItIsSteadyForTheLeastTime) {
  const StoppedBox box;
  ASSERT_FALSE(io::read_local_data(box.output).window.steady);
  const auto data = measured_so_far(box.file, 2.0 * box.strain, box.output);
  ASSERT_TRUE(data);
  EXPECT_TRUE(data->window.steady);
  EXPECT_GE(data->window.end - data->window.begin, 2.0 * box.strain);
  EXPECT_GE(data->window.begin, dem::steady_criteria(box.file.scene).start_up);
}

TEST(MeasuredSoFar, TheFileIsThatOfASceneThatAskedForNoMore) {
  const StoppedBox box;
  const auto data = measured_so_far(box.file, 2.0 * box.strain, box.output);
  ASSERT_TRUE(data);
  const io::RunRecord record = io::read_run_record(box.output);
  EXPECT_EQ(record.data.window.end, data->window.end);
  EXPECT_EQ(record.data.rows.size(), data->rows.size());
  const io::SceneFile again = io::parse_scene(record.scene_text, "again.toml");
  EXPECT_DOUBLE_EQ(again.scene.measurement.averaging_time, 2.0 * box.strain);
  EXPECT_FALSE(std::filesystem::exists(io::checkpoint_path(box.output)));
}

TEST(MeasuredSoFar, ARunTooShortForTheLeastTimeStaysAsItIs) {
  const StoppedBox box;
  const std::string before = io::read_file(box.output);
  EXPECT_FALSE(measured_so_far(box.file, 10.0 * box.strain, box.output));
  EXPECT_EQ(io::read_file(box.output), before);
  EXPECT_TRUE(std::filesystem::exists(io::checkpoint_path(box.output)));
}

TEST(MeasuredSoFar, TheFileOfAnotherSceneTellsNothing) {
  const StoppedBox box;
  io::SceneFile other = box.file;
  other.text += "# another\n";
  EXPECT_FALSE(measured_so_far(other, 2.0 * box.strain, box.output));
}

TEST(MeasuredSoFar, ARunWithoutAFileHasMeasuredNothing) {
  const io::TemporaryDirectory directory;
  const io::SceneFile none{};
  EXPECT_FALSE(measured_so_far(none, 1.0, directory.path() / "none.h5"));
}

}  // namespace
}  // namespace grainlaw
