#include "apps/io/checkpoint_hdf5.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <bit>
#include <csignal>
#include <limits>
#include <random>
#include <thread>

#include "apps/io/local_data_hdf5.h"
#include "apps/io/safe_write.h"
#include "apps/io/sealed_file.h"
#include "tests/apps/io/temporary_directory.h"

namespace grainlaw::io {
namespace {

namespace fs = std::filesystem;

SceneFile any_scene() {
  SceneFile file;
  file.text = "units = \"grain\"\n# a comment\n";
  file.scene.seed = 42;
  return file;
}

/// A state of `size` numbers of any bits, with a count to know it by.
dem::Checkpoint any_checkpoint(std::size_t size, std::int64_t count) {
  std::mt19937_64 random(static_cast<std::uint64_t>(count));
  dem::Checkpoint checkpoint;
  std::vector<double>& numbers = checkpoint.numbers["grains/position"];
  for (std::size_t k = 0; k < size; ++k) numbers.push_back(std::bit_cast<double>(random()));
  checkpoint.integers["count"] = {count};
  checkpoint.texts["law"] = "hooke";
  return checkpoint;
}

std::int64_t count_of(const NewestCheckpoint& newest) {
  return newest.stored ? newest.stored->checkpoint.integers.at("count").at(0) : -1;
}

/// Equality of doubles does not see the bits of NaN and -0.
std::vector<std::uint64_t> bits(const std::vector<double>& values) {
  std::vector<std::uint64_t> out;
  for (const double value : values) out.push_back(std::bit_cast<std::uint64_t>(value));
  return out;
}

/// An output with checkpoints 1 (previous) and 2 (newest).
struct TwoGenerations {
  explicit TwoGenerations(std::size_t size = 40) {
    write_checkpoint(any_checkpoint(size, 1), any_scene(), output);
    write_checkpoint(any_checkpoint(size, 2), any_scene(), output);
  }
  TemporaryDirectory directory;
  fs::path output = directory / "run.h5";

  void damage(const fs::path& path, const std::string& bytes) const {
    directory.write(path.filename().string(), bytes);
  }
};

TEST(CheckpointHdf5, EveryBitComesBack) {
  const TemporaryDirectory directory;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double denormal = std::numeric_limits<double>::denorm_min();
  dem::Checkpoint state = any_checkpoint(1000, 7);
  state.numbers["special"] = {-0.0, 0.0, nan, -nan, denormal, -1.0 / 0.0};
  state.numbers["grains/spin"] = {};
  state.integers["extremes"] = {
      std::numeric_limits<std::int64_t>::min(), -1, std::numeric_limits<std::int64_t>::max()};
  state.integers["none"] = {};
  state.texts["empty"] = "";
  state.texts["zeros"] = std::string("a\0b\0\0", 5);
  write_checkpoint(state, any_scene(), directory / "run.h5");
  const StoredCheckpoint again = read_checkpoint(checkpoint_path(directory / "run.h5"));
  ASSERT_EQ(again.checkpoint.numbers.size(), state.numbers.size());
  for (const auto& [name, values] : state.numbers) {
    EXPECT_EQ(bits(again.checkpoint.numbers.at(name)), bits(values)) << name;
  }
  EXPECT_EQ(again.checkpoint.integers, state.integers);
  EXPECT_EQ(again.checkpoint.texts, state.texts);
}

TEST(CheckpointHdf5, AStateOfNothingComesBack) {
  const TemporaryDirectory directory;
  write_checkpoint({}, any_scene(), directory / "run.h5");
  EXPECT_EQ(read_checkpoint(checkpoint_path(directory / "run.h5")).checkpoint, dem::Checkpoint{});
}

TEST(CheckpointHdf5, TheFileKnowsWhatItBelongsTo) {
  const TemporaryDirectory directory;
  write_checkpoint(any_checkpoint(1, 1), any_scene(), directory / "run.h5");
  const StoredCheckpoint stored = read_checkpoint(checkpoint_path(directory / "run.h5"));
  EXPECT_EQ(stored.scene_text, any_scene().text);
  EXPECT_EQ(stored.seed, 42u);
  EXPECT_FALSE(stored.version.empty());
}

TEST(CheckpointHdf5, FilesInTheFolderWhereItRunsDoNotMatter) {
  const TemporaryDirectory directory;
  const fs::path before = fs::current_path();
  fs::current_path(directory.path());
  fs::create_directory("grainlaw");  // a checkout, say
  write_checkpoint(any_checkpoint(10, 5), any_scene(), "run.h5");
  EXPECT_EQ(count_of(newest_checkpoint("run.h5")), 5);
  fs::current_path(before);
}

TEST(CheckpointHdf5, TheSameStateGivesTheSameBytes) {
  const TemporaryDirectory directory;
  const auto bytes = [&](const std::string& name) {
    write_checkpoint(any_checkpoint(500, 3), any_scene(), directory / name);
    return read_file(checkpoint_path(directory / name));
  };
  const std::string first = bytes("a.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // dates count seconds
  EXPECT_EQ(first, bytes("b.h5"));
}

TEST(CheckpointHdf5, TheNewestIsUsedAndTheOneBeforeIsKept) {
  const TwoGenerations run;
  const NewestCheckpoint newest = newest_checkpoint(run.output);
  EXPECT_EQ(count_of(newest), 2);
  EXPECT_EQ(newest.note, "");
  EXPECT_EQ(newest.path, checkpoint_path(run.output));
  EXPECT_EQ(read_checkpoint(previous_checkpoint_path(run.output)).checkpoint.integers.at("count"),
            std::vector<std::int64_t>{1});
  remove_checkpoints(run.output);
  EXPECT_FALSE(newest_checkpoint(run.output).stored);
  EXPECT_TRUE(fs::is_empty(run.directory.path()));
}

/// The previous generation is used, and the note says what is wrong with the newest.
void expect_fallback(const TwoGenerations& run, const std::string& why, std::size_t place) {
  const NewestCheckpoint newest = newest_checkpoint(run.output);
  ASSERT_EQ(count_of(newest), 1) << place;
  EXPECT_EQ(newest.path, previous_checkpoint_path(run.output));
  EXPECT_NE(newest.note.find(checkpoint_path(run.output).string()), std::string::npos);
  EXPECT_NE(newest.note.find(why), std::string::npos) << place << ": " << newest.note;
}

TEST(CheckpointHdf5, ANewestCutShortAtAnyLengthGivesWayToThePrevious) {
  const TwoGenerations run;
  const std::string bytes = read_file(checkpoint_path(run.output));
  for (std::size_t length = 0; length < bytes.size(); length += length < 600 ? 7 : 97) {
    run.damage(checkpoint_path(run.output), bytes.substr(0, length));
    expect_fallback(run, "", length);
  }
  expect_fallback(run, "is cut short", 0);
}

TEST(CheckpointHdf5, AFlippedByteAnywhereGivesWayToThePrevious) {
  const TwoGenerations run;
  const std::string bytes = read_file(checkpoint_path(run.output));
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    std::string changed = bytes;
    const std::size_t at = random() % changed.size();
    changed[at] ^= static_cast<char>(1 + random() % 255);
    run.damage(checkpoint_path(run.output), changed);
    expect_fallback(run, "", at);
  }
}

TEST(CheckpointHdf5, ForeignFilesAndNewerFormatsAreNamedAsSuch) {
  const TwoGenerations run;
  const auto expect = [&](const std::string& bytes, const std::string& why) {
    run.damage(checkpoint_path(run.output), bytes);
    expect_fallback(run, why, 0);
  };
  expect("", "is empty");
  expect("this is text", "is not a file that grainlaw wrote");
  expect(seal("local data", 1, "x"), "a checkpoint file is wanted");
  expect(seal("checkpoint", 2, "x"), "has format 2");
  expect(seal("checkpoint", 1, "x"), "cannot read the HDF5 part");
}

TEST(CheckpointHdf5, ARunIsNoCheckpoint) {
  const TwoGenerations run;
  write_local_data({}, any_scene(), run.output);
  fs::rename(run.output, checkpoint_path(run.output));
  expect_fallback(run, "a checkpoint file is wanted", 0);
}

TEST(CheckpointHdf5, TwoDamagedGenerationsAreASentenceThatNamesBoth) {
  const TwoGenerations run;
  run.damage(checkpoint_path(run.output), "");
  run.damage(previous_checkpoint_path(run.output), "text");
  try {
    newest_checkpoint(run.output);
    FAIL();
  } catch (const ReadError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find("run.h5.checkpoint is empty"), std::string::npos) << what;
    EXPECT_NE(what.find("run.h5.checkpoint.previous is not a file"), std::string::npos) << what;
  }
}

TEST(CheckpointHdf5, ADamagedNewestDoesNotPushOutAGoodPrevious) {
  const TwoGenerations run;
  run.damage(checkpoint_path(run.output), "damaged");
  write_checkpoint(any_checkpoint(40, 3), any_scene(), run.output);
  EXPECT_EQ(count_of(newest_checkpoint(run.output)), 3);
  run.damage(checkpoint_path(run.output), "damaged again");
  EXPECT_EQ(count_of(newest_checkpoint(run.output)), 1);
}

TEST(CheckpointHdf5, AWriterKilledAtAnyMomentLeavesAValidCheckpoint) {
  const TemporaryDirectory directory;
  const fs::path output = directory / "run.h5";
  constexpr std::size_t size = 100000;  // 800 kB: writing takes milliseconds
  std::int64_t count = 0;
  write_checkpoint(any_checkpoint(size, count), any_scene(), output);
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 30; ++trial) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (std::int64_t next = count;; ++next) {
        write_checkpoint(any_checkpoint(size, next), any_scene(), output);
      }
    }
    ::usleep(static_cast<useconds_t>(random() % 30000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const NewestCheckpoint newest = newest_checkpoint(output);
    EXPECT_EQ(newest.note, "") << "trial " << trial;  // at most absent, never damaged
    ASSERT_GE(count_of(newest), count) << "trial " << trial;
    count = count_of(newest);
    const dem::Checkpoint& state = newest.stored->checkpoint;
    EXPECT_EQ(bits(state.numbers.at("grains/position")),
              bits(any_checkpoint(size, count).numbers.at("grains/position")));
  }
  remove_temporaries(checkpoint_path(output));
  remove_checkpoints(output);
  EXPECT_TRUE(fs::is_empty(directory.path()));
}

TEST(CheckpointHdf5, AFullDiskLeavesBothGenerations) {
  const TwoGenerations run;
  // A limit on the size of files fails like a full disk: write() returns an error part of the way.
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_checkpoint(any_checkpoint(100000, 3), any_scene(), run.output);
    } catch (const FileError& error) {
      std::_Exit(std::string(error.what()).find("File too large") != std::string::npos ? 7 : 8);
    }
    std::_Exit(9);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(count_of(newest_checkpoint(run.output)), 2);
  EXPECT_EQ(read_checkpoint(previous_checkpoint_path(run.output)).seed, 42u);
  EXPECT_EQ(std::distance(fs::directory_iterator(run.directory.path()), {}), 2);
}

}  // namespace
}  // namespace grainlaw::io
