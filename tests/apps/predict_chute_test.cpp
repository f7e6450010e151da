// grainlaw-predict on chutes, as a person meets it: sweeps and the certificate.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

struct Output {
  int code = -1;
  std::string text;
};

Output run(const std::string& command) {
  Output output;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), pipe) != nullptr) output.text += buffer.data();
  output.code = WEXITSTATUS(pclose(pipe));
  return output;
}

const std::string data = GRAINLAW_DATA;
const std::string frictional = data + "/tables/shi2020_mu_p_0.50.toml";

Output predict(const std::string& arguments) {
  return run(std::string(GRAINLAW_BIN) + "/grainlaw-predict " + arguments);
}

class PredictChute : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  std::string write(const std::string& text) const {
    std::ofstream(folder / "case.toml") << text;
    return (folder / "case.toml").string();
  }
  Output sweep(const std::string& axes, const std::string& answer = "steady") const {
    return predict(write("units = \"grain\"\nanswer = \"" + answer +
                         "\"\n[chute]\ninclination = 24\nmass_per_area = 30\n[sweep]\n" + axes) +
                   " --table " + frictional);
  }

  fs::path folder = fs::temp_directory_path() / ("grainlaw-chute-" + std::to_string(getpid()));
};

using Rows = std::vector<std::vector<std::string>>;

Rows rows_of(const std::string& csv) {
  Rows rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream fields(line + ",");
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

TEST_F(PredictChute, ASweepIsOneRowForEachCombinationWithItsOutcome) {
  const Output output = sweep("inclination = [18, 24, 33.2, 36]\nstiffness = [2e4, 2e5]\n");
  EXPECT_EQ(output.code, 0) << output.text;
  const Rows rows = rows_of(output.text);
  ASSERT_EQ(rows.size(), 9U);
  for (const auto& row : rows) EXPECT_EQ(row.size(), 12U);
  EXPECT_EQ(rows[0][2], "outcome");
  EXPECT_EQ(rows[1][2], "ARRESTED");  // repose is 19.4 degrees; softer grains slip more easily
  EXPECT_EQ(rows[3][2], "STEADY");
  // p* 1.3e-3 at the base: mu / f_p = 0.694 lies between mu(I_phi) = 0.672 and mu_inf = 0.715
  EXPECT_EQ(rows[5][2], "NO_DENSE_STATE");
  EXPECT_EQ(rows[7][2], "NO_STEADY");
}

TEST_F(PredictChute, ARowOfASweepIsThePredictionOfItsCase) {
  const Output table = sweep(
      "inclination = [22, 24]\ncoefficients = [\"mu0\"]\n"
      "coefficient_values = [[0.3, 0.353]]\n");
  const Rows rows = rows_of(table.text);
  ASSERT_EQ(rows.size(), 5U) << table.text;
  const Output alone = predict(
      write("units = \"grain\"\nanswer = \"steady\"\n[chute]\ninclination = 24\nmass_per_area = "
            "30\n") +
      " --table " + frictional + " --json");
  const auto json = nlohmann::json::parse(alone.text);
  const auto& velocity = json["surface_velocity"];
  const double expected =
      velocity.is_object() ? velocity["value"].get<double>() : velocity.get<double>();
  EXPECT_NEAR(std::stod(rows[4][5]), expected, 1e-9 * expected);  // 10 digits are written
  EXPECT_GT(std::stod(rows[3][5]), expected);  // less yield friction flows faster
}

TEST_F(PredictChute, ASweepOverDepthFindsTheMass) {
  const Output output = sweep("depth = [20, 25]\n");
  const Rows rows = rows_of(output.text);
  ASSERT_EQ(rows.size(), 3U) << output.text;
  EXPECT_NEAR(std::stod(rows[1][3]), 20.0, 1e-8);
  EXPECT_NEAR(std::stod(rows[2][3]), 25.0, 1e-8);
}

TEST_F(PredictChute, AnUnknownCoefficientIsRefusedWithTheNamesThereAre) {
  const Output output = sweep("coefficients = [\"mu_0\"]\ncoefficient_values = [[0.3]]\n");
  EXPECT_EQ(output.code, 1);
  EXPECT_NE(output.text.find("case.toml:7:1"), std::string::npos) << output.text;
  EXPECT_NE(output.text.find("it has mu0 beta kappa p_mu"), std::string::npos) << output.text;
}

TEST_F(PredictChute, ASweepThatCannotBeMeantIsRefused) {
  EXPECT_EQ(sweep("inclination = [24]\n", "start").code, 1);
  EXPECT_EQ(sweep("depth = [20]\nmass_per_area = [30]\n").code, 1);
  EXPECT_EQ(sweep("inclination = []\n").code, 1);
  EXPECT_EQ(sweep("coefficients = [\"mu0\"]\n").code, 1);
  EXPECT_EQ(sweep("").code, 1);
}

TEST_F(PredictChute, ACoefficientThatTheLawForbidsIsARowNotTheEnd) {
  const Output output = sweep("coefficients = [\"mu0\"]\ncoefficient_values = [[-0.1, 0.353]]\n");
  EXPECT_EQ(output.code, 0) << output.text;
  EXPECT_NE(output.text.find("-0.1,TABLE_REFUSED"), std::string::npos) << output.text;
}

TEST_F(PredictChute, TheCertificateSaysWhereTheLawAndTheFlowAreWellPosed) {
  const Output output =
      predict(data + "/cases/chute.toml --certificate --json --table " + frictional);
  ASSERT_EQ(output.code, 0) << output.text;
  const auto json = nlohmann::json::parse(output.text);
  EXPECT_EQ(json["well_posed_softness_0_bond_0"], "I 0.0261 to 2.45");
  EXPECT_GT(json["certificate_margin"].get<double>(), 0.0);
}

}  // namespace
}  // namespace grainlaw
