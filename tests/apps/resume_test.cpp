// Runs that are stopped, killed, copied or out of disk, as a person meets them.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

struct Output : grainlaw::testing::CommandOutput {
  nlohmann::json json() const {
    return nlohmann::json::parse(text.substr(text.find('{'), text.rfind('}') - text.find('{') + 1));
  }
};

Output shell(const std::string& command) {
  return {grainlaw::testing::run_command(command)};
}

const std::string bin = GRAINLAW_BIN;

/// A program in the background; killed when the test leaves it running.
class Background {
 public:
  explicit Background(std::vector<std::string> words) : id_(::fork()) {
    if (id_ != 0) return;
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments.front(), arguments.data());
    std::_Exit(127);
  }
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { end(SIGKILL); }

  /// Sends the signal and waits; the exit code, or -1 when the signal ended it.
  int end(int signal) {
    if (id_ <= 0) return -1;
    ::kill(id_, signal);
    int status = 0;
    ::waitpid(std::exchange(id_, -1), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t id_;
};

class Resume : public testing::Test {
 protected:
  Resume() {
    fs::create_directories(folder_);
    write_scene("24");
  }
  ~Resume() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  bool there(const std::string& name) const { return fs::exists(path(name)); }

  /// Twenty square diameters, five deep: seconds, not minutes.
  void write_scene(const std::string& tilt, const std::string& name = "scene.toml") const {
    std::ofstream(path(name))
        << "name = \"small\"\nunits = \"grain\"\n"
           "[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\nrestitution = 0.88\n"
           "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
           "[geometry]\nkind = \"chute\"\ninclination = "
        << tilt
        << "\nlength = 5\nwidth = 4\ndepth = 5\n"
           "[measurement]\naveraging_time = 40\ntime_limit = 400\n";
  }
  /// Runs the scene to OUTPUT with more arguments.
  Output dem(const std::string& output, const std::string& more = {}) const {
    return shell(bin + "/grainlaw dem " + path("scene.toml") + " -o " + path(output) + " --json " +
                 more);
  }
  /// A run that stops at the first occasion.
  Output stopped(const std::string& output, const std::string& more = {}) const {
    return dem(output, "--max-wall 0.001s " + more);
  }
  std::vector<std::string> command(const std::string& output) const {
    return {bin + "/grainlaw-dem",
            path("scene.toml"),
            "-o",
            path(output),
            "--resume",
            "--checkpoint-interval",
            "0.01s"};
  }
  /// Digest of a run that nothing interrupted.
  std::string whole_digest() const {
    const Output whole = dem("whole.h5");
    EXPECT_TRUE(whole.code == 0 || whole.code == 2) << whole.text;
    return whole.json()["digest"];
  }
  void wait_for(const std::string& name) const {
    for (int k = 0; k < 3000 && !there(name); ++k) ::usleep(10000);
    ASSERT_TRUE(there(name)) << name;
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("grainlaw-resume-" + std::to_string(getpid()));
};

TEST_F(Resume, ARunStoppedByMaxWallGoesOnToTheSameBytes) {
  const Output first = stopped("run.h5");
  EXPECT_EQ(first.code, 4) << first.text;
  EXPECT_TRUE(first.says("--resume")) << first.text;
  EXPECT_TRUE(there("run.h5.checkpoint"));
  for (int stop = 0; stop < 3; ++stop) EXPECT_EQ(stopped("run.h5", "--resume").code, 4);
  const Output last = dem("run.h5", "--resume");
  EXPECT_TRUE(last.says("goes on from")) << last.text;
  EXPECT_TRUE(last.json()["resumed"].get<bool>());
  EXPECT_EQ(last.json()["digest"], whole_digest());
  for (const char* left : {"run.h5.checkpoint", "run.h5.checkpoint.previous", "run.h5.lock"}) {
    EXPECT_FALSE(there(left)) << left;
  }
}

TEST_F(Resume, CheckpointsAndThreadsDoNotChangeTheRun) {
  const Output often = dem("often.h5", "--checkpoint-interval 0.01s --threads 2");
  EXPECT_EQ(often.json()["digest"], whole_digest());
  EXPECT_FALSE(often.json()["resumed"].get<bool>());
  EXPECT_GT(often.json()["grain_steps_per_second"].get<double>(), 0.0);
}

TEST_F(Resume, ARunKilledAgainAndAgainGoesOnToTheSameBytes) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 10; ++trial) {
    Background program(command("run.h5"));
    ::usleep(static_cast<useconds_t>(30000 + random() % 300000));
    program.end(SIGKILL);
  }
  const Output last = dem("run.h5", "--resume");
  EXPECT_TRUE(last.code == 0 || last.code == 2) << last.text;
  EXPECT_EQ(last.json()["digest"], whole_digest());
  for (const auto& file : fs::directory_iterator(path(""))) {
    EXPECT_FALSE(file.path().string().ends_with(".tmp")) << file.path();
  }
}

TEST_F(Resume, SignalsEndARunWithACheckpoint) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    Background program(command("run.h5"));
    wait_for("run.h5.lock");  // it catches signals before
    EXPECT_EQ(program.end(signal), 4) << signal;
    EXPECT_TRUE(there("run.h5.checkpoint"));
  }
  EXPECT_EQ(dem("run.h5", "--resume").json()["digest"], whole_digest());
}

/// Twenty thousand grains close to random close packing: their packing takes minutes.
TEST_F(Resume, ARunThatIsBeingPackedStopsAndBeginsAnew) {
  std::ofstream(path("scene.toml"))
      << "name = \"dense\"\nunits = \"grain\"\n"
         "[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\nrestitution = 0.88\n"
         "[geometry]\nkind = \"simple_shear\"\nshear_rate = 0.1\nvolume = \"fixed\"\n"
         "volume_fraction = 0.63\ngrains = 20000\n";
  const Output late = dem("run.h5", "--max-wall 0.2s");
  EXPECT_EQ(late.code, 4) << late.text;
  EXPECT_TRUE(late.says("before the flow started")) << late.text;
  EXPECT_TRUE(there("run.h5.checkpoint"));
  Background program(command("run.h5"));
  wait_for("run.h5.lock");
  EXPECT_EQ(program.end(SIGTERM), 4);
  EXPECT_EQ(dem("run.h5", "--resume --max-wall 0.1s").code, 4);
}

TEST_F(Resume, ADamagedCheckpointGivesWayToTheOneBefore) {
  stopped("run.h5");
  stopped("run.h5", "--resume");
  ASSERT_TRUE(there("run.h5.checkpoint.previous"));
  fs::resize_file(path("run.h5.checkpoint"), 1000);
  const Output again = dem("run.h5", "--resume");
  EXPECT_TRUE(again.says("is cut short")) << again.text;
  EXPECT_TRUE(again.says("goes on from " + path("run.h5.checkpoint.previous"))) << again.text;
  EXPECT_EQ(again.json()["digest"], whole_digest());
}

TEST_F(Resume, TwoDamagedCheckpointsAreRefused) {
  stopped("run.h5");
  stopped("run.h5", "--resume");
  fs::resize_file(path("run.h5.checkpoint"), 1000);
  fs::resize_file(path("run.h5.checkpoint.previous"), 0);
  const Output again = dem("run.h5", "--resume");
  EXPECT_EQ(again.code, 1);
  EXPECT_TRUE(again.says("without --resume it starts anew")) << again.text;
}

TEST_F(Resume, AChangedSceneIsRefusedWithTheLineThatChanged) {
  stopped("run.h5");
  write_scene("25");
  const Output changed = dem("run.h5", "--resume");
  EXPECT_EQ(changed.code, 1);
  EXPECT_TRUE(changed.says("belongs to another text of the scene")) << changed.text;
  EXPECT_TRUE(changed.says("inclination = 24")) << changed.text;
  EXPECT_TRUE(there("run.h5.checkpoint"));
}

TEST_F(Resume, WithoutACheckpointARunStartsFromTheBeginningAndSaysSo) {
  const Output first = dem("run.h5", "--resume");
  EXPECT_TRUE(first.says("starts from the beginning")) << first.text;
  EXPECT_FALSE(first.json()["resumed"].get<bool>());
}

TEST_F(Resume, WithoutResumeAnUnfinishedRunIsMentionedAndReplaced) {
  stopped("run.h5");
  const Output anew = dem("run.h5");
  EXPECT_TRUE(anew.says("unfinished run")) << anew.text;
  EXPECT_FALSE(anew.json()["resumed"].get<bool>());
  EXPECT_FALSE(there("run.h5.checkpoint"));
}

TEST_F(Resume, TheSameOutputIsNotMadeTwiceAtOnce) {
  Background program(command("run.h5"));
  wait_for("run.h5.lock");
  const Output second = dem("run.h5");
  EXPECT_EQ(second.code, 3);
  EXPECT_TRUE(second.says("by another grainlaw program")) << second.text;
  program.end(SIGKILL);
  EXPECT_NE(dem("run.h5", "--resume").code, 3);
}

TEST_F(Resume, AFullDiskIsSaidOnceAndEndsInASentence) {
  // A limit on the size of files fails like a full disk: no file can be above 512 or 1024 bytes.
  const Output full = shell("ulimit -f 1; " + bin + "/grainlaw dem " + path("scene.toml") + " -o " +
                            path("run.h5") + " --checkpoint-interval 0.01s");
  EXPECT_EQ(full.code, 3) << full.text;
  const std::size_t first = full.text.find("no checkpoint: cannot write");
  ASSERT_NE(first, std::string::npos) << full.text;
  EXPECT_EQ(full.text.find("no checkpoint: cannot write", first + 1), std::string::npos);
  EXPECT_FALSE(there("run.h5"));
}

TEST_F(Resume, DurationsAndThreadsAreCheckedBeforeAnythingRuns) {
  EXPECT_EQ(dem("run.h5", "--max-wall soon").code, 1);
  EXPECT_EQ(dem("run.h5", "--checkpoint-interval 0").code, 1);
  EXPECT_EQ(dem("run.h5", "--threads 0").code, 1);
  EXPECT_EQ(dem("run.h5", "--threads -2").code, 1);
  EXPECT_FALSE(there("run.h5"));
  const Output many = stopped("run.h5", "--threads 1000");
  EXPECT_EQ(many.code, 4);
  EXPECT_TRUE(many.says("cores")) << many.text;
  EXPECT_LT(many.json()["threads"].get<int>(), 1000);
}

TEST_F(Resume, AnInterruptedCampaignGoesOnToTheSameRuns) {
  std::ofstream(path("campaign.toml")) << "title = \"small\"\nscene = \"scene.toml\"\n"
                                          "[tilts]\ncalibrate = [25.0, 27.0]\npredict = [26.0]\n";
  const auto calibrate = [&](const std::string& folder, const std::string& more) {
    return shell(bin + "/grainlaw calibrate " + path("campaign.toml") + " --threads 2 -o " +
                 path(folder) + " " + more);
  };
  const Output first = calibrate("stopped", "--max-wall 0.001s");
  EXPECT_EQ(first.code, 4) << first.text;
  EXPECT_TRUE(first.says("the same command goes on")) << first.text;
  calibrate("stopped", "--max-wall 1s");
  const Output last = calibrate("stopped", "");
  const Output whole = calibrate("whole", "");
  EXPECT_EQ(last.code, whole.code) << last.text << whole.text;
  for (const char* run : {"theta25", "theta26", "theta27"}) {
    EXPECT_FALSE(there("stopped/runs/" + std::string(run) + ".h5.checkpoint")) << run;
  }
  const auto table = [&](const std::string& folder) {
    std::ifstream file(path(folder + "/table.toml"));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(table("stopped"), table("whole"));
}

}  // namespace
