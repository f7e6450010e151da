// Campaigns of many runs as a person meets them: made, killed, listed, gathered.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

struct Output : grainlaw::testing::CommandOutput {
  nlohmann::json json() const {
    const std::size_t begin = text.find("\n{");
    return nlohmann::json::parse(text.substr(begin == std::string::npos ? 0 : begin));
  }
};

Output shell(const std::string& command) {
  return {grainlaw::testing::run_command(command)};
}

const std::string bin = GRAINLAW_BIN;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Ids of the processes that a process has started.
std::vector<pid_t> children(pid_t parent) {
  const std::string id = std::to_string(parent);
  std::ifstream file("/proc/" + id + "/task/" + id + "/children");
  return {std::istream_iterator<pid_t>(file), {}};
}

class Campaigns : public testing::Test {
 protected:
  Campaigns() {
    fs::create_directories(folder_);
    write_boxes(100);
    write_campaign("");
  }
  ~Campaigns() override { fs::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  bool there(const std::string& name) const { return fs::exists(path(name)); }

  /// Soft grains sheared fast: a fraction of a second each.
  void write_boxes(int grains, const std::string& more = {}) const {
    std::ofstream(path("box.toml"))
        << "units = \"stiffness\"\n"
        << more << "[contact.normal]\nlaw = \"hooke\"\ndashpot = 0.1\n"
        << "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
        << "[geometry]\nkind = \"simple_shear\"\nshear_rate = 0.01\npressure = 0.01\n"
        << "grains = " << grains << "\n";
  }
  void write_campaign(const std::string& top, const std::string& strain = "3.0") const {
    std::ofstream(path("campaign.toml"))
        << top
        << "[[shear_boxes]]\nscene = \"box.toml\"\ninertial_number = [0.1, 0.14, 0.2, 0.22]\n"
        << "strain = " << strain << "\n";
  }
  std::string command(const std::string& folder) const {
    return bin + "/grainlaw calibrate " + path("campaign.toml") + " --threads 2 --json -o '" +
           path(folder) + "'";
  }
  Output calibrate(const std::string& folder, const std::string& more = {}) const {
    return shell(command(folder) + " " + more);
  }

  /// The program in the background, its words in a file.
  pid_t start(const std::string& folder) const {
    const pid_t id = ::fork();
    if (id != 0) return id;
    const int log = ::open(path("log").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(log, STDOUT_FILENO);
    ::dup2(log, STDERR_FILENO);
    const std::string program = bin + "/grainlaw-calibrate";
    const std::string campaign = path("campaign.toml");
    const std::string out = path(folder);
    ::execl(program.c_str(),
            program.c_str(),
            campaign.c_str(),
            "--threads",
            "2",
            "-o",
            out.c_str(),
            nullptr);
    std::_Exit(127);
  }
  /// The first children it has; empty when it ends before it has some.
  std::vector<pid_t> wait_for_children(pid_t id) const {
    for (int k = 0; k < 6000; ++k) {
      const std::vector<pid_t> found = children(id);
      if (!found.empty()) return found;
      ::usleep(10000);
    }
    return {};
  }
  int exit_code(pid_t id) const {
    int status = 0;
    ::waitpid(id, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("grainlaw-campaign-" + std::to_string(getpid()));
};

TEST_F(Campaigns, BoxesGiveALawAndFinishedRunsAreKept) {
  const Output first = calibrate("out");
  ASSERT_EQ(first.code, 0) << first.text;
  for (const char* file :
       {"table.toml", "report.html", "report.json", "runs/I0.2_p0.01_Bo0.toml"}) {
    EXPECT_TRUE(there("out/" + std::string(file))) << file;
  }
  EXPECT_TRUE(first.json().contains("mu0")) << first.text;
  const std::string table = read(path("out/table.toml"));
  EXPECT_NE(table.find("geometry = \"simple_shear\""), std::string::npos) << table;

  const Output again = calibrate("out");
  EXPECT_EQ(again.json()["runs_kept"], 4) << again.text;
  EXPECT_EQ(read(path("out/table.toml")), table);

  fs::resize_file(path("out/runs/I0.2_p0.01_Bo0.h5"), 1000);
  const Output mended = calibrate("out");
  EXPECT_EQ(mended.json()["runs_kept"], 3) << mended.text;
  EXPECT_TRUE(mended.says("is cut short")) << mended.text;
  EXPECT_EQ(read(path("out/table.toml")), table);

  write_boxes(100, "seed = 5\n");
  const Output other = calibrate("out");
  EXPECT_FALSE(other.json().contains("runs_kept")) << other.text;
  EXPECT_TRUE(there("out/runs/replaced/I0.1_p0.01_Bo0.h5")) << other.text;
}

TEST_F(Campaigns, AKilledRunTakesOnlyItselfDown) {
  const pid_t program = start("out");
  const std::vector<pid_t> runs = wait_for_children(program);
  ASSERT_FALSE(runs.empty());
  ::kill(runs.front(), SIGKILL);
  EXPECT_EQ(exit_code(program), 0) << read(path("log"));
  EXPECT_NE(read(path("log")).find("ended by signal 9"), std::string::npos) << read(path("log"));
  const std::string why = read(path("out/runs/failed/I0.1_p0.01_Bo0.txt"));
  EXPECT_NE(why.find("signal 9"), std::string::npos) << why;
  EXPECT_TRUE(there("out/runs/failed/I0.1_p0.01_Bo0.toml"));
  EXPECT_FALSE(there("out/runs/I0.1_p0.01_Bo0.h5"));
  const Output again = calibrate("out");
  EXPECT_EQ(again.json()["runs_kept"], 3) << again.text;
  EXPECT_EQ(again.json()["runs"], 4) << again.text;
  EXPECT_FALSE(there("out/runs/failed/I0.1_p0.01_Bo0.txt"));
}

TEST_F(Campaigns, ARunWhosePhysicsFailsIsNamedAndTheOthersGoOn) {
  const std::string box = read(path("box.toml"));
  std::ofstream(path("tight.toml")) << "max_overlap = 0.01\n" << box;  // less than p* alone makes
  std::ofstream(path("campaign.toml"), std::ios::app)
      << "[[shear_boxes]]\nscene = \"tight.toml\"\ninertial_number = [0.17]\nstrain = 3.0\n";
  const Output output = calibrate("out");
  EXPECT_EQ(output.code, 0) << output.text;
  EXPECT_EQ(output.json()["runs"], 4) << output.text;
  EXPECT_NE(output.json()["runs_failed"].dump().find("I0.17_p0.01_Bo0"), std::string::npos);
  EXPECT_NE(read(path("out/runs/failed/I0.17_p0.01_Bo0.txt")).find("overlap"), std::string::npos);
  EXPECT_NE(read(path("out/report.html")).find("I0.17_<wbr/>p0.01_<wbr/>Bo0"), std::string::npos);
}

TEST_F(Campaigns, AStoppedCampaignGoesOnToTheSameTable) {
  const pid_t program = start("stopped");
  ASSERT_FALSE(wait_for_children(program).empty());
  ::kill(program, SIGINT);
  ::kill(program, SIGINT);
  EXPECT_EQ(exit_code(program), 4) << read(path("log"));
  const Output late = calibrate("stopped", "--max-wall 0.2s");
  EXPECT_TRUE(late.code == 4 || late.code == 0) << late.text;
  EXPECT_EQ(calibrate("stopped").code, 0);
  EXPECT_EQ(calibrate("whole").code, 0);
  EXPECT_EQ(read(path("stopped/table.toml")), read(path("whole/table.toml")));
}

TEST_F(Campaigns, AKilledCampaignLeavesNoRunBehindAndGoesOn) {
  const pid_t program = start("out");
  const std::vector<pid_t> runs = wait_for_children(program);
  ASSERT_FALSE(runs.empty());
  ::kill(program, SIGKILL);
  exit_code(program);
  for (const pid_t run : runs) {  // they write a checkpoint and end
    for (int k = 0; k < 6000 && ::kill(run, 0) == 0; ++k) ::usleep(10000);
    EXPECT_NE(::kill(run, 0), 0);
  }
  EXPECT_EQ(calibrate("out").code, 0);
}

TEST_F(Campaigns, SeedsAreReportedBesideTheErrors) {
  write_campaign("seeds = [1, 2]\n");
  const Output output = calibrate("out");
  ASSERT_EQ(output.code, 0) << output.text;
  EXPECT_EQ(output.json()["runs"], 8);
  EXPECT_TRUE(output.json().contains("seed_scatter_I0.1_p0.01_Bo0_mu")) << output.text;
  EXPECT_TRUE(there("out/runs/I0.1_p0.01_Bo0_s2.h5"));
}

TEST_F(Campaigns, AListRunsWhereverAndIsGatheredToTheSameTable) {
  const std::string folder = "it's a folder";
  const Output list = shell(bin + "/grainlaw calibrate " + path("campaign.toml") + " --list -o \"" +
                            path(folder) + "\"");
  ASSERT_EQ(list.code, 0) << list.text;
  EXPECT_EQ(std::count(list.text.begin(), list.text.end(), '\n'), 4) << list.text;
  EXPECT_TRUE(list.text.starts_with("grainlaw dem '")) << list.text;  // a name to be quoted
  EXPECT_TRUE(there(folder + "/runs/I0.22_p0.01_Bo0.toml"));
  EXPECT_FALSE(there(folder + "/runs/I0.22_p0.01_Bo0.h5"));
  std::ofstream(path("list")) << list.text;
  const bool parallel = shell("command -v parallel && parallel --version").code == 0;
  const std::string run = parallel ? "parallel -j 2 --will-cite" : "sh";
  const Output made = shell("PATH=" + bin + ":$PATH " + run + " < " + path("list"));
  EXPECT_EQ(made.code, 0) << made.text;
  const Output gathered = shell(bin + "/grainlaw calibrate " + path("campaign.toml") + " -o " +
                                path("gathered") + " --from \"" + path(folder) + "/runs\"");
  EXPECT_EQ(gathered.code, 0) << gathered.text;
  EXPECT_EQ(calibrate("whole").code, 0);
  EXPECT_EQ(read(path("gathered/table.toml")), read(path("whole/table.toml")));
  if (!parallel) GTEST_SKIP() << "GNU parallel is not installed: the list was run by sh";
}

TEST_F(Campaigns, ABudgetSpreadsItsFirstRunsAndThenGoesOnWhereTheyLeaveMostUnknown) {
  const Output budget = calibrate("out", "--budget 12s");
  ASSERT_EQ(budget.code, 0) << budget.text;
  EXPECT_TRUE(there("out/table.toml"));
  // The ends of ln I and the place farthest from both, a run each.
  for (const char* name : {"I0.1_p0.01_Bo0_b1", "I0.22_p0.01_Bo0_b1", "I0.14_p0.01_Bo0_b1"}) {
    EXPECT_TRUE(there(std::string("out/runs/") + name + ".h5")) << budget.text;
  }
  const auto report = nlohmann::json::parse(read(path("out/report.json")));
  const auto& rounds = report["budget"]["rounds"];
  ASSERT_GE(rounds.size(), 1u);
  EXPECT_EQ(rounds[0]["runs"].size(), 3u);
  EXPECT_NE(read(path("out/report.html")).find("id=\"budget\""), std::string::npos);
}

TEST_F(Campaigns, ABudgetTooSmallForThreeRunsNamesOneThatIsNot) {
  write_campaign("", "3000.0");  // three shortest runs of 188 strains each
  const Output budget = calibrate("out", "--budget 4s");
  EXPECT_EQ(budget.code, 2) << budget.text;
  EXPECT_TRUE(budget.says("too small") && budget.says("give at least")) << budget.text;
  EXPECT_FALSE(there("out"));
  const Output check = calibrate("out", "--budget 4s --check");
  EXPECT_EQ(check.code, 2) << check.text;
  EXPECT_TRUE(check.says("too small")) << check.text;
}

TEST_F(Campaigns, AReferenceIsNotWrittenOver) {
  const std::string published = std::string(GRAINLAW_DATA) + "/tables/shi2020_mu_p_0.50.toml";
  fs::create_directories(path("out"));
  fs::copy_file(published, path("out/table.toml"));
  const Output refused = calibrate("out", "--reference " + path("out/table.toml"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_TRUE(refused.says("overwritten")) << refused.text;
  EXPECT_EQ(read(path("out/table.toml")), read(published));
}

TEST_F(Campaigns, OptionsOfACampaignDoNotGoWithTables) {
  const std::string published = std::string(GRAINLAW_DATA) + "/tables/shi2020_mu_p_0.50.toml";
  for (const char* option : {"--list", "--budget 9s", "--max-wall 9s"}) {
    const Output refused = shell(bin + "/grainlaw calibrate " + option + " --tables " + published);
    EXPECT_EQ(refused.code, 1);
    EXPECT_TRUE(refused.says("not with --tables")) << refused.text;
  }
}

TEST_F(Campaigns, ABudgetNeedsConditionsToChooseFrom) {
  std::ofstream(path("campaign.toml"))
      << "[[shear_boxes]]\nscene = \"box.toml\"\ninertial_number = [0.1, 0.2]\nstrain = 3\n";
  for (const char* how : {"", " --check"}) {
    const Output budget = calibrate("out", "--budget 10s" + std::string(how));
    EXPECT_EQ(budget.code, 2) << budget.text;
    EXPECT_TRUE(budget.says("at least 3 conditions")) << budget.text;
  }
}

TEST_F(Campaigns, ACheckTellsTheFirstRunsOfABudget) {
  const auto told = calibrate("out", "--budget 1h --check").json();
  EXPECT_EQ(told["candidates"].size(), 4U);
  EXPECT_EQ(told["first_runs"].size(), 3U);
  EXPECT_FALSE(there("out"));
}

TEST_F(Campaigns, ACheckTellsWhatGivenRunsAreGoodFor) {
  ASSERT_EQ(calibrate("out").code, 0);
  fs::remove(path("out/runs/I0.14_p0.01_Bo0.h5"));
  const auto told = calibrate("again", "--check --from " + path("out/runs")).json();
  EXPECT_EQ(told["fitted"].size() + told["left_out"].size(), 3U);
  EXPECT_EQ(told["missing"], nlohmann::json({"I0.14_p0.01_Bo0"}));
  EXPECT_FALSE(there("again"));
  EXPECT_EQ(calibrate("again", "--check --from " + path("nothing.h5")).code, 1);
}

TEST_F(Campaigns, RunsOfOtherGrainsOrStatesAreRefused) {
  ASSERT_EQ(calibrate("out").code, 0);
  write_campaign("", "4.0");  // averaged for longer: the same states
  EXPECT_EQ(calibrate("again", "--from " + path("out/runs")).code, 0);
  write_boxes(200);
  EXPECT_EQ(calibrate("again", "--from " + path("out/runs")).code, 0);
  std::ofstream(path("box.toml"), std::ios::app) << "[grains]\nsize_ratio = 2.0\n";
  const Output other = calibrate("again", "--from " + path("out/runs"));
  EXPECT_EQ(other.code, 1);
  EXPECT_TRUE(other.says("are not those of the campaign")) << other.text;
}

}  // namespace
