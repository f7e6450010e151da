// grainlaw study as a person meets it.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/apps/io/temporary_directory.h"
#include "tests/support/shell.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;

Output study(const std::string& arguments) {
  return grainlaw::testing::run_command(std::string(GRAINLAW_BIN) + "/grainlaw study " + arguments);
}

std::string read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// A hundred equal grains in homogeneous shear: a fraction of a second.
constexpr const char* box = R"(units = "stiffness"
max_overlap = 0.5
[contact.normal]
law = "hooke"
dashpot = 0.05
[contact.friction]
law = "sliding"
coefficient = 0.5
[geometry]
kind = "simple_shear"
shear_rate = 1e-2
pressure = 0.01
grains = 100
volume_fraction = 0.58
[measurement]
averaging_time = 400.0
time_limit = 4000.0
)";

class StudyProgram : public ::testing::Test {
 protected:
  std::string time_step(const std::string& more = {}) const {
    folder_.write("box.toml", box);
    return folder_.write("steps.toml",
                         "kind = \"time_step\"\nscene = \"box.toml\"\n"
                         "steps_per_contact = [10, 20, 40]\n" +
                             more);
  }
  std::string results() const { return folder_ / "results"; }

  io::TemporaryDirectory folder_;
};

TEST_F(StudyProgram, DrawsARefusedTimeStepAsAFailureAndEnergyFallsWithTheStep) {
  const Output output = study(time_step() + " -o " + results());
  ASSERT_EQ(output.code, 0) << output.text;
  const std::string csv = read(fs::path(results()) / "study.csv");
  EXPECT_NE(csv.find("mu,mu,t/10,,,,,,\"time step refused"), std::string::npos) << csv;
  EXPECT_NE(csv.find("mu,mu,t/20,"), std::string::npos) << csv;
  EXPECT_EQ(csv.find("mu,mu,t/40,"), std::string::npos) << "the finest is the reference";
  const auto residual = [&](const std::string& step) {
    std::istringstream line(csv.substr(csv.find("energy,energy," + step)));
    std::string field;
    for (int k = 0; k < 7; ++k) std::getline(line, field, ',');
    return std::stod(field);
  };
  EXPECT_LT(residual("t/40"), residual("t/20"));
  EXPECT_TRUE(fs::exists(fs::path(results()) / "study.html"));
  EXPECT_NE(output.text.find("what to choose"), std::string::npos);
}

TEST_F(StudyProgram, KeepsFinishedRunsAndTheirCost) {
  const std::string arguments = time_step() + " -o " + results();
  ASSERT_EQ(study(arguments).code, 0);
  const std::string first = read(fs::path(results()) / "study.csv");
  const auto written = fs::last_write_time(fs::path(results()) / "runs" / "step20.h5");
  const Output again = study(arguments);
  EXPECT_EQ(again.code, 0);
  EXPECT_NE(again.text.find("step20: kept"), std::string::npos) << again.text;
  EXPECT_EQ(fs::last_write_time(fs::path(results()) / "runs" / "step20.h5"), written);
  const std::string second = read(fs::path(results()) / "study.csv");
  EXPECT_EQ(first.substr(first.find("mu,mu,t/10")).substr(0, 40),
            second.substr(second.find("mu,mu,t/10")).substr(0, 40));
}

TEST_F(StudyProgram, StoppedByMaxWallItGoesOnWithTheSameCommand) {
  const std::string arguments = time_step() + " -o " + results();
  const Output stopped = study(arguments + " --max-wall 0.02");
  EXPECT_EQ(stopped.code, 4) << stopped.text;
  EXPECT_NE(stopped.text.find("the same command goes on"), std::string::npos) << stopped.text;
  EXPECT_EQ(study(arguments).code, 0);
}

TEST_F(StudyProgram, RunsAnUnstableStepWhenAllowedTo) {
  const Output output = study(time_step("allow_unstable_step = true\n") + " -o " + results());
  ASSERT_EQ(output.code, 0) << output.text;
  EXPECT_TRUE(fs::exists(fs::path(results()) / "runs" / "step10.h5"));
}

TEST_F(StudyProgram, CheckListsTheRunsAndRunsNothing) {
  const Output output = study(time_step() + " -o " + results() + " --check");
  EXPECT_EQ(output.code, 0) << output.text;
  EXPECT_NE(output.text.find("DEM run step20"), std::string::npos) << output.text;
  EXPECT_NE(output.text.find("t/10: time step refused"), std::string::npos) << output.text;
  EXPECT_FALSE(fs::exists(results()));
}

TEST_F(StudyProgram, ASceneThatDoesNotFitTheKindIsBadInput) {
  folder_.write("box.toml", box);
  const std::string path =
      folder_.write("base.toml", "kind = \"base\"\nscene = \"box.toml\"\nsides = [5, 8]\n");
  const Output output = study(path + " -o " + results());
  EXPECT_EQ(output.code, 1) << output.text;
  EXPECT_NE(output.text.find("this study takes a chute"), std::string::npos) << output.text;
}

// Where the stress is uniform so is the fluidity, and the nonlocal law is the local one (Kamrin and
// Koval 2012): both solvers have their profiles to 1e-4.
TEST_F(StudyProgram, NonlocalLawIsTheLocalOneInUniformShear) {
  const Output output =
      study(std::string(GRAINLAW_DATA) + "/studies/law_bands.toml -o " + results());
  ASSERT_EQ(output.code, 0) << output.text;
  const std::string csv = read(fs::path(results()) / "study.csv");
  const auto error = [&](const std::string& law) {
    const std::string quantity = "velocity of plane_shear,velocity of plane_shear,";
    const std::size_t at = csv.find(quantity + law + ",");
    EXPECT_NE(at, std::string::npos) << law << "\n" << csv;
    std::istringstream line(csv.substr(at));
    std::string field;
    for (int k = 0; k < 7; ++k) std::getline(line, field, ',');
    return std::stod(field);
  };
  EXPECT_NEAR(error("nonlocal"), error("mu(I) + p*"), 1e-4);
  EXPECT_NE(csv.find("chutes are predicted by local laws"), std::string::npos) << csv;
}

TEST_F(StudyProgram, TheExamplesAreGoodInput) {
  for (const char* name : {"solver", "whole", "averaging_time", "kernel", "law", "law_bands"}) {
    const Output output = study(std::string(GRAINLAW_DATA) + "/studies/" + name + ".toml --check");
    EXPECT_EQ(output.code, 0) << name << ": " << output.text;
  }
}

}  // namespace
}  // namespace grainlaw
