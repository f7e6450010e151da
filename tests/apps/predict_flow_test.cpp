// grainlaw-predict on flows that are no chute, as a person meets it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/shell.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;
const auto run = grainlaw::testing::run_command;

const std::string data = GRAINLAW_DATA;

Output predict(const std::string& question, const std::string& more) {
  return run(std::string(GRAINLAW_BIN) + "/grainlaw-predict " + question + " --table " + data +
             "/tables/" + more);
}

Output predict_shipped(const std::string& name, const std::string& more) {
  return predict(data + "/cases/" + name + ".toml", more);
}

class PredictFlow : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string write(const std::string& text) const {
    std::ofstream(path("case.toml")) << text;
    return path("case.toml");
  }
  const fs::path folder =
      fs::temp_directory_path() / ("grainlaw_predict_flow_" + std::to_string(getpid()));
};

TEST_F(PredictFlow, ShippedCasesHaveAnAnswer) {
  for (const char* name :
       {"plane_shear", "body_force_box", "annular_shear", "split_bottom", "ring_cell"}) {
    const Output answer = predict_shipped(name, "shi2020_mu_p_0.50.toml --json");
    ASSERT_EQ(answer.code, 0) << answer.text;
    const auto json = nlohmann::json::parse(answer.text);
    EXPECT_EQ(json["outcome"], "STEADY") << name;
    EXPECT_NE(json["trust"].get<std::string>().find("1.90 times"), std::string::npos) << name;
  }
}

TEST_F(PredictFlow, ThinLocalBandIsFlaggedAndStillAnAnswer) {
  const std::string band =
      "units = \"grain\"\n[geometry]\nkind = \"plane_shear\"\nvelocity = 0.01\nheight = 60\n"
      "load = 20\ngravity = 1\n";
  const Output local = predict(write(band), "shi2020_mu_p_0.50.toml --json");
  ASSERT_EQ(local.code, 0) << local.text;
  const auto collapsed = nlohmann::json::parse(local.text);
  EXPECT_TRUE(collapsed["local_band_collapse"].get<bool>());
  EXPECT_LT(collapsed["yielded_width"].get<double>(), 5.0);
  EXPECT_EQ(
      collapsed["collapse_text"].get<std::string>().find("the local law yields over less than 5 d"),
      0U);
  const Output nonlocal =
      predict(write(band + "[nonlocal]\namplitude = 0.48\n"), "shi2020_mu_p_0.50.toml --json");
  ASSERT_EQ(nonlocal.code, 0) << nonlocal.text;
  EXPECT_FALSE(nlohmann::json::parse(nonlocal.text)["local_band_collapse"].get<bool>());
}

TEST_F(PredictFlow, LocalBandIsFollowedFromRestToTheSteadyOne) {
  const auto json = nlohmann::json::parse(
      predict_shipped("body_force_box", "shi2020_mu_p_0.50.toml --json").text);
  EXPECT_EQ(json["start_outcome"], "STEADY");
  EXPECT_GT(json["time_to_steady"].get<double>(), 0.0);
  // the edge of a band lies in one of 100 cells, the band spans a third of them: (1/33)^2
  EXPECT_LT(std::abs(json["difference_from_quadrature"].get<double>()), 1e-3);
}

TEST_F(PredictFlow, NoFlowIsCode2WithItsReason) {
  const std::string still =
      "units = \"grain\"\n[geometry]\nkind = \"plane_shear\"\nstress = 3.0\nheight = 20\n"
      "load = 10\n";
  const Output rest = predict(write(still), "shi2020_mu_p_0.50.toml");
  EXPECT_EQ(rest.code, 2);
  EXPECT_NE(rest.text.find("ARRESTED"), std::string::npos) << rest.text;
  const std::string deep =
      "units = \"grain\"\n[geometry]\nkind = \"split_bottom\"\nsplit_radius = 40\ndepth = 29\n"
      "rotation_rate = 0.01\n";
  const Output paths = predict(write(deep), "shi2020_mu_p_0.50.toml");
  EXPECT_EQ(paths.code, 2);
  EXPECT_NE(paths.text.find("paths of least torque"), std::string::npos) << paths.text;
}

TEST_F(PredictFlow, ATableOfPhiOnlyGivesCurvesAndNoFlow) {
  EXPECT_EQ(predict_shipped("simple_shear", "shi2020_phi_mu_p_0.30.toml").code, 0);
  for (const char* flow : {"chute", "plane_shear", "split_bottom"}) {
    const Output refused = predict_shipped(flow, "shi2020_phi_mu_p_0.30.toml");
    EXPECT_EQ(refused.code, 1);
    EXPECT_NE(refused.text.find("phi only"), std::string::npos) << refused.text;
  }
}

TEST_F(PredictFlow, WritesProfilesWithTheirCoordinate) {
  const std::pair<const char*, const char*> expected[] = {{"plane_shear", "\nz ["},
                                                          {"body_force_box", "\ny ["},
                                                          {"annular_shear", "\nr ["},
                                                          {"split_bottom", "\nz ["},
                                                          {"ring_cell", "\nz ["},
                                                          {"simple_shear", "inertial_number,"}};
  for (const auto& [name, header] : expected) {
    const std::string csv = path(std::string(name) + ".csv");
    const std::string json = path(std::string(name) + ".json");
    ASSERT_EQ(predict_shipped(name, "shi2020_mu_p_0.50.toml -o " + csv).code, 0);
    ASSERT_EQ(predict_shipped(name, "shi2020_mu_p_0.50.toml -o " + json).code, 0);
    std::ifstream file(csv);
    const std::string text((std::istreambuf_iterator<char>(file)), {});
    EXPECT_NE(text.find(header), std::string::npos) << name;
    std::ifstream parsed(json);
    EXPECT_TRUE(nlohmann::json::accept(parsed)) << name;
  }
}

TEST_F(PredictFlow, AStressHasTheUnitOfItsCase) {
  for (const auto& [name, unit] :
       {std::pair("plane_shear", " m g/d^2\n"), {"annular_shear", " Pa\n"}})
    EXPECT_NE(predict_shipped(name, "shi2020_mu_p_0.50.toml").text.find(unit), std::string::npos);
}

TEST_F(PredictFlow, CheckSaysWhatIsLeftOut) {
  const Output answer = predict_shipped("body_force_box", "shi2020_mu_p_0.50.toml --check");
  EXPECT_EQ(answer.code, 0);
  EXPECT_NE(answer.text.find("nonlocal fluidity"), std::string::npos) << answer.text;
}

}  // namespace
}  // namespace grainlaw
