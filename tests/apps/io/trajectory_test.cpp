#include "apps/io/trajectory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <regex>

#include "apps/io/hdf5_file.h"
#include "apps/io/safe_write.h"
#include "apps/io/scene_input.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

namespace fs = std::filesystem;

constexpr const char* text = R"(name = "small"
units = "grain"
[contact.normal]
law = "hooke"
stiffness = 2e4
restitution = 0.88
[contact.friction]
law = "sliding"
coefficient = 0.5
[geometry]
kind = "chute"
inclination = 24
length = 5
width = 4
depth = 4
[measurement]
averaging_time = 8
time_limit = 12
)";

SceneFile small_scene() {
  return parse_scene(text, "small.toml");
}

dem::LocalData run_with(TrajectoryWriter* writer, const dem::Checkpoint* resume = nullptr) {
  dem::RunOptions options;
  options.resume = resume;
  options.snapshot_interval = 1.0;
  if (writer != nullptr) {
    options.snapshot = [writer](const dem::Snapshot& snapshot) { writer->add(snapshot); };
  }
  dem::LocalData data = dem::run(small_scene().scene, options);
  if (writer != nullptr) writer->finish();
  return data;
}

std::size_t count(const std::string& where, const std::string& what) {
  const std::regex pattern(what);
  return static_cast<std::size_t>(std::distance(
      std::sregex_iterator(where.begin(), where.end(), pattern), std::sregex_iterator()));
}

/// A small run, written once for all tests.
struct Written {
  TemporaryDirectory directory;
  TrajectoryWriter writer{directory / "run.h5", false, {.xyz = true}};
  dem::LocalData data = run_with(&writer);
  std::string file(const std::string& name) const { return read_file(directory / name); }
};
const Written& written() {
  static const Written run;
  return run;
}

TEST(Trajectory, WritingItDoesNotChangeThePathOfTheGrains) {
  const dem::LocalData without = run_with(nullptr);
  const auto& with = written().data;
  ASSERT_EQ(with.frames.frames.size(), without.frames.frames.size());
  for (std::size_t k = 0; k < without.frames.frames.size(); ++k) {
    EXPECT_EQ(with.frames.frames[k].kinetic_energy, without.frames.frames[k].kinetic_energy);
    EXPECT_EQ(with.frames.frames[k].centre_of_mass, without.frames.frames[k].centre_of_mass);
  }
  EXPECT_EQ(with.summary.energy_residual, without.summary.energy_residual);
}

TEST(Trajectory, SnapshotsFollowTheInterval) {
  const auto end = written().data.frames.frames.back().end;
  const std::string sidecar = written().file("run.xdmf");
  // One at the start and one for each whole time unit of the run.
  EXPECT_EQ(count(sidecar, "<Time Value"), 1 + static_cast<std::size_t>(end));
  for (std::size_t k = 0; k < count(sidecar, "<Time Value"); ++k) {
    char name[40];
    std::snprintf(name, sizeof name, "run.grains/%08zu.h5", k);
    const std::string bytes = written().file(name);
    const Hdf5Reader in(bytes, name);
    const double time = in.number("/", "time");
    EXPECT_GE(time, static_cast<double>(k));
    EXPECT_LT(time, static_cast<double>(k) + 0.5) << "later than a sample";
    EXPECT_NE(sidecar.find(std::string(name) + ":/position"), std::string::npos);
  }
}

TEST(Trajectory, ASnapshotHoldsEveryGrainInsideTheBox) {
  const std::string bytes = written().file("run.grains/00000002.h5");
  const Hdf5Reader in(bytes, "snapshot");
  const auto& summary = written().data.summary;
  const auto grains = static_cast<std::size_t>(summary.flowing_grains + summary.base_grains);
  const auto body = in.integers("body", {grains});
  EXPECT_EQ(std::ranges::count(body, 0), summary.flowing_grains);
  const auto position = in.numbers("position", {grains, 3});
  const auto velocity = in.numbers("velocity", {grains, 3});
  const auto radius = in.numbers("radius", {grains});
  for (std::size_t k = 0; k < grains; ++k) {
    EXPECT_GE(position[3 * k], -1.0);  // wrapped when lists are made: a grain may be just outside
    EXPECT_LE(position[3 * k], 6.0);
    EXPECT_EQ(radius[k], 0.5);
    if (body[k] != 0) {
      EXPECT_EQ(velocity[3 * k], 0.0);
    }
  }
}

TEST(Trajectory, ExtendedXyzHasALineForEachGrain) {
  const std::string xyz = written().file("run.grains/00000001.xyz");
  const auto& summary = written().data.summary;
  const int grains = summary.flowing_grains + summary.base_grains;
  EXPECT_TRUE(xyz.starts_with(std::to_string(grains) + "\nLattice=\"5 0 0 0 4 0 0 0 ")) << xyz;
  EXPECT_NE(xyz.find("pbc=\"T T F\""), std::string::npos);
  EXPECT_EQ(std::ranges::count(xyz, '\n'), grains + 2);
}

TEST(Trajectory, ARunThatGoesOnKeepsItsSnapshots) {
  const TemporaryDirectory directory;
  dem::Snapshot snapshot;
  snapshot.state.grains.resize(2);
  {
    TrajectoryWriter writer(directory / "run.h5", false, {});
    for (const double time : {0.0, 1.0, 2.0, 3.0, 4.0}) {
      snapshot.time = time;
      writer.add(snapshot);
    }  // killed: no finish
  }
  directory.write("run.grains/00000005.h5.1234.0.tmp", "half a sna");
  EXPECT_EQ(count(read_file(directory / "run.xdmf"), "<Time Value"), 4u);  // 1, 2, 4
  TrajectoryWriter writer(directory / "run.h5", true, {});
  for (const double time : {3.0, 4.0, 5.0}) {  // goes on from a checkpoint at 2.5
    snapshot.time = time;
    writer.add(snapshot);
  }
  writer.finish();
  EXPECT_EQ(count(read_file(directory / "run.xdmf"), "<Time Value"), 6u);
  EXPECT_FALSE(fs::exists(directory / "run.grains/00000006.h5"));
  EXPECT_FALSE(fs::exists(directory / "run.grains/00000005.h5.1234.0.tmp"));
}

TEST(Trajectory, AFolderWithOtherFilesIsNotTouched) {
  const TemporaryDirectory directory;
  fs::create_directories(directory / "run.grains");
  directory.write("run.grains/thesis.txt", "mine");
  EXPECT_THROW(TrajectoryWriter(directory / "run.h5", false, {}), ReadError);
  EXPECT_EQ(read_file(directory / "run.grains/thesis.txt"), "mine");
}

}  // namespace
}  // namespace grainlaw::io
