// `grainlaw compare` on runs that are no chutes, as a person meets it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;

Output grainlaw(const std::string& arguments) {
  return grainlaw::testing::run_command(std::string(GRAINLAW_BIN) + "/grainlaw " + arguments);
}

const std::string tables = std::string(GRAINLAW_DATA) + "/tables/";

/// One small run of plane shear and one of simple shear, made once.
class CompareFlows : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    fs::create_directories(folder);
    run("walls",
        "units = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\nrestitution = 0.7\n"
        "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
        "[geometry]\nkind = \"plane_shear\"\nvelocity = 2.0\nload = 10.0\nlength = 6.0\n"
        "width = 6.0\ngrains = 330\n[geometry.wall]\nrecipe = \"bumpy\"\n"
        "[measurement]\naveraging_time = 10.0\ntime_limit = 30.0\n");
    run("box",
        "units = \"stiffness\"\n[contact.normal]\nlaw = \"hooke\"\ndashpot = 0.05\n"
        "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
        "[geometry]\nkind = \"simple_shear\"\nshear_rate = 1e-2\npressure = 0.01\ngrains = 150\n"
        "volume_fraction = 0.55\n[measurement]\naveraging_time = 600.0\ntime_limit = 2000.0\n");
  }
  static void TearDownTestSuite() { fs::remove_all(folder); }

  static void run(const std::string& name, const std::string& scene) {
    std::ofstream(folder / (name + ".toml")) << "name = \"" << name << "\"\n" << scene;
    const Output made = grainlaw("dem " + file(name, ".toml") + " --quiet -o " + file(name));
    ASSERT_TRUE(fs::exists(file(name))) << made.text;
  }
  static std::string file(const std::string& name, const std::string& ending = ".h5") {
    return (folder / (name + ending)).string();
  }
  static nlohmann::json report(const std::string& name) {
    std::ifstream in(folder / name / "report.json");
    return nlohmann::json::parse(in);
  }

  static inline const fs::path folder =
      fs::temp_directory_path() / ("grainlaw-compare-" + std::to_string(getpid()));
};

TEST_F(CompareFlows, EveryRunIsHeldAgainstEveryTable) {
  const Output answer =
      grainlaw("compare " + file("walls") + " " + file("box") + " --table " + tables +
               "shi2020_mu_p_0.50.toml " + tables +
               "shi2020_mu_p_0.01.toml --nonlocal 0.48 --json -o " + file("both", ""));
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_NE(answer.text.find("contact friction 0.5"), std::string::npos) << "another material";
  const auto json = report("both");
  ASSERT_EQ(json["flows"].size(), 2u);
  ASSERT_EQ(json["scores"].size(), 2u);
  const auto& walls = json["flows"][0]["tables"][0];
  EXPECT_EQ(walls["kind"], "independent table");
  EXPECT_FALSE(walls["local"].is_null());
  EXPECT_FALSE(walls["nonlocal"].is_null());
  const auto& box = json["flows"][1]["tables"][0]["states"];
  ASSERT_EQ(box.size(), 1u);
  // I = gd sqrt(rho_p / p) d and p* as the scene asks for them: 1e-2 / sqrt(0.01), 0.01. The
  // pressure is held to a few percent over a run this short.
  EXPECT_NEAR(box[0]["inertial_number"]["value"].get<double>(), 0.1, 0.005);
  EXPECT_NEAR(box[0]["softness"]["value"].get<double>(), 0.01, 0.001);
  EXPECT_GT(box[0]["condition_number"].get<double>(), 1.0);
}

TEST_F(CompareFlows, ACheckSaysWhatTheTableAnswers) {
  const Output answer = grainlaw("compare " + file("walls") + " --table " + tables +
                                 "shi2020_mu_p_0.50.toml --check");
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_NE(answer.text.find("plane_shear"), std::string::npos) << answer.text;
  EXPECT_NE(answer.text.find("STEADY"), std::string::npos) << answer.text;
}

TEST_F(CompareFlows, ALawOfOneTiltIsRefusedForOtherFlows) {
  const Output answer = grainlaw("compare " + file("box") + " --table " + tables +
                                 "brewster2008_example.toml -o " + file("refused", ""));
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("mu(I)"), std::string::npos) << answer.text;
}

TEST_F(CompareFlows, WhatIsGivenTwiceOrContradictsItselfIsRefused) {
  const std::string table = tables + "shi2020_mu_p_0.50.toml";
  fs::copy_file(file("box"), file("copy"), fs::copy_options::overwrite_existing);
  const std::pair<std::string, const char*> cases[] = {
      {file("box") + " " + file("copy") + " -t " + table, "the same run is given twice"},
      {file("box") + " -t " + table + " " + table, "the same table is given twice"},
      {file("box") + " -t " + tables + "shi2020_phi_mu_p_0.30.toml", "0.30.toml: has phi only"},
      {file("box") + " -t ''", "an empty text is given"},
      {"'' -t " + table, "an empty text is given"},
      {file("walls") + " -t " + table + " --nonlocal 0.5 --fit-nonlocal", "give one"},
      {file("walls") + " -t " + table + " --nonlocal -1", "'-1' is no number above 0"},
      {file("walls") + " -t " + table + " --nonlocal nan", "'nan' is no number above 0"},
      {file("walls") + " -t " + table + " --nonlocal inf", "'inf' is no number above 0"},
      {file("walls") + " -t " + table + " --nonlocal 1x", "'1x' is no number above 0"},
  };
  for (const auto& [arguments, why] : cases) {
    const Output answer = grainlaw("compare " + arguments + " -o " + file("twice", ""));
    EXPECT_EQ(answer.code, 1) << arguments;
    EXPECT_NE(answer.text.find(why), std::string::npos) << answer.text;
    EXPECT_LT(answer.text.size(), 300U) << answer.text;
    EXPECT_FALSE(fs::exists(file("twice", "")));
  }
}

TEST_F(CompareFlows, ARunThatIsNotSteadyIsWarnedOfEvenQuietly) {
  run("short",
      "units = \"grain\"\n[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\n"
      "restitution = 0.88\n[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
      "[geometry]\nkind = \"chute\"\ninclination = 26\nlength = 5\nwidth = 4\ndepth = 5\n"
      "[measurement]\naveraging_time = 10\ntime_limit = 12\n");
  const Output answer = grainlaw("compare " + file("short") + " -t " + tables +
                                 "shi2020_mu_p_0.50.toml --quiet -o " + file("unsteady", ""));
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_NE(answer.text.find("warning: short is not steady"), std::string::npos) << answer.text;
}

TEST_F(CompareFlows, ALaterReportRemovesThePicturesOfAnEarlierOneAndNothingElse) {
  const auto compare = [&](const char* name) {
    const Output answer = grainlaw("compare " + file(name) + " -t " + tables +
                                   "shi2020_mu_p_0.50.toml --quiet -o " + file("reused", ""));
    EXPECT_EQ(answer.code, 0) << answer.text;
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder / "reused" / "plots"))
      names.insert(entry.path().filename().string());
    return names;
  };
  compare("walls");
  std::ofstream(folder / "reused" / "plots" / "mine.svg") << "drawn by hand";
  auto reused = compare("box");
  EXPECT_EQ(reused.erase("mine.svg"), 1U);
  fs::remove_all(folder / "reused");
  EXPECT_EQ(reused, compare("box"));
}

TEST_F(CompareFlows, AnAmplitudeNeedsABand) {
  const Output answer = grainlaw("compare " + file("box") + " --table " + tables +
                                 "shi2020_mu_p_0.50.toml --fit-nonlocal -o " + file("none", ""));
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("--fit-nonlocal needs"), std::string::npos) << answer.text;
}

/// The dry cell of data/local with a published table of its contact friction.
TEST_F(CompareFlows, ARingCellIsComparedOverItsCrossSection) {
  const Output answer =
      grainlaw("compare " + std::string(GRAINLAW_DATA) + "/local/shear_bands/ring_dry.h5 --table " +
               tables + "shi2020_mu_p_0.01.toml --fit-nonlocal -o " + file("ring", ""));
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json json = report("ring");
  const auto& flow = json["flows"][0];
  const auto& local = flow["tables"][0]["ring_local"];
  const auto& nonlocal = flow["tables"][0]["ring_nonlocal"];
  EXPECT_EQ(local["outcome"], "STEADY");
  EXPECT_EQ(local["comparison"]["rows"].size(), flow["ring"]["rows"].size());
  EXPECT_LT(local["comparison"]["velocity"]["value"], 0.1);
  EXPECT_LT(nonlocal["comparison"]["velocity"]["value"],
            0.5 * local["comparison"]["velocity"]["value"].get<double>());
}

}  // namespace
