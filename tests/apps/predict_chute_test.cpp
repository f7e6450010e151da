// grainlaw-predict on chutes, as a person meets it: sweeps and the certificate.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/shell.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;
const auto run = grainlaw::testing::run_command;

const std::string data = GRAINLAW_DATA;
const std::string frictional = data + "/tables/shi2020_mu_p_0.50.toml";

Output predict(const std::string& arguments) {
  return run(std::string(GRAINLAW_BIN) + "/grainlaw-predict " + arguments);
}

class PredictChute : public ::testing::Test {
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

/// The summary of a shipped case.
nlohmann::json answer(const std::string& name) {
  const Output output = predict(data + "/cases/" + name + ".toml --json --table " + frictional);
  EXPECT_EQ(output.code, 0) << output.text;
  return nlohmann::json::parse(output.text);
}

TEST_F(PredictChute, DepthFoundForAFlowCarriesThatFlow) {
  const auto found = answer("depth_for_flow");
  EXPECT_NEAR(found["mass_flow"].get<double>(), 50.0, 1e-7);  // found to 1e-9
  const auto back = predict(write("units = \"si\"\nanswer = \"steady\"\n[grains]\n"
                                  "diameter = 2e-3\ndensity = 2500\n[chute]\ninclination = 24\n"
                                  "gravity = 9.81\ndepth = " +
                                  found["height"].dump()) +
                            " --json --table " + frictional);
  EXPECT_NEAR(nlohmann::json::parse(back.text)["mass_flow"].get<double>(), 50.0, 1e-6);
}

TEST_F(PredictChute, TiltFoundForAFlowHasTheDepthAskedFor) {
  const auto found = answer("tilt_for_flow");
  EXPECT_NEAR(found["mass_flow"].get<double>(), 50.0, 1e-6);
  EXPECT_NEAR(found["height"].get<double>(), 0.05, 1e-9);
}

TEST_F(PredictChute, LargestFlowIsToldOfTheDataAndOfTheLaw) {
  const auto found = answer("largest_flow");
  EXPECT_EQ(found["largest_ended_by"], "data");
  EXPECT_EQ(found["law_limit_outcome"], "NO_DENSE_STATE");
  EXPECT_LT(found["mass_flow"].get<double>(), found["law_mass_flow"].get<double>());
}

TEST_F(PredictChute, FlowThatNoDepthCarriesIsRefusedInTheUnitsOfTheFile) {
  const Output output =
      predict(write("units = \"si\"\n[grains]\ndiameter = 2e-3\ndensity = 2500\nstiffness = 1000\n"
                    "[chute]\ngravity = 9.81\ninclination = 24\nmass_flow = 1e30\n") +
              " --table " + frictional);
  EXPECT_EQ(output.code, 2);
  EXPECT_NE(output.text.find("1e+30 kg/(m s); the nearest: "), std::string::npos) << output.text;
  EXPECT_NE(output.text.find("I_phi"), std::string::npos) << output.text;
}

TEST_F(PredictChute, BagnoldTableIsNotAskedForATilt) {
  const Output output = predict(data + "/cases/tilt_for_flow.toml --table " + data +
                                "/tables/brewster2008_example.toml");
  EXPECT_EQ(output.code, 1);
  EXPECT_NE(output.text.find("own tilt only"), std::string::npos) << output.text;
}

TEST_F(PredictChute, MoistGlassFromItsDataSheetIsAsGoodAsRigid) {
  const auto found = answer("moist_glass_si");
  EXPECT_EQ(found["stiff_enough"], true);
  // E d / (3 (1 - nu^2)), and pi sqrt(m / 2 k_n) / 50
  const double stiffness = 7e10 * 2e-3 / (3.0 * (1.0 - 0.22 * 0.22));
  const double mass = 2500.0 * std::numbers::pi / 6.0 * 8e-9;
  const double step = std::numbers::pi * std::sqrt(mass / (2.0 * stiffness)) / 50.0;
  EXPECT_NEAR(found["stiffness"].get<double>() / stiffness, 1.0, 1e-12);
  EXPECT_NEAR(found["time_step"].get<double>() / step, 1.0, 1e-12);
  // p = rho_bulk g cos(theta) H, and both numbers from it
  const double pressure =
      found["mass_per_area"].get<double>() * 9.81 * std::cos(21.5 * std::numbers::pi / 180.0);
  const double pull = std::numbers::pi * 2e-3 * 0.072 * std::cos(20.0 * std::numbers::pi / 180.0);
  EXPECT_NEAR(found["softness_base"].get<double>() * stiffness / (pressure * 2e-3), 1.0, 1e-12);
  EXPECT_NEAR(found["bond_number_base"].get<double>() * pressure * 4e-6 / pull, 1.0, 1e-12);
}

TEST_F(PredictChute, SoftestStiffnessMovesTheSurfaceByOnePercent) {
  const auto speed = [&](double stiffness) {
    const Output output = predict(
        write("units = \"grain\"\nanswer = \"steady\"\n[grains]\nstiffness = " +
              std::to_string(stiffness) + "\n[chute]\ninclination = 23\nmass_per_area = 30\n") +
        " --json --table " + frictional);
    return nlohmann::json::parse(output.text);
  };
  const auto stiff = speed(1e9);
  const auto soft = speed(stiff["softest_stiffness"].get<double>());
  const double change = soft["surface_velocity"]["value"].get<double>() /
                            stiff["surface_velocity"]["value"].get<double>() -
                        1.0;
  EXPECT_NEAR(change, 0.01, 1e-4);  // k_n is found to 1e-4 of at most 32 in its logarithm
}

TEST_F(PredictChute, WhetherGrainsAreAsGoodAsRigidIsToldWithWhatFollows) {
  const auto words = [&](const char* stiffness) {
    const Output output = predict(
        write(std::string("units = \"grain\"\nanswer = \"steady\"\n[grains]\nstiffness = ") +
              stiffness + "\n[chute]\ninclination = 23\nmass_per_area = 30\n") +
        " --json --table " + frictional);
    return nlohmann::json::parse(output.text)["rigid_text"].get<std::string>();
  };
  EXPECT_EQ(words("1e10"),
            "rigid grains have this surface velocity within 1 %: k_n hardly matters here");
  EXPECT_EQ(words("2e4"),
            "rigid grains have another surface velocity by more than 1 %: k_n matters here, and "
            "neither rigid nor much softer grains may stand for these");
}

/// A coefficient of the published table replaced by one that no grains have.
class ImpossibleCoefficient
    : public PredictChute,
      public ::testing::WithParamInterface<std::pair<const char*, const char*>> {};

TEST_P(ImpossibleCoefficient, IsRefusedAtItsPlaceForEveryQuestion) {
  const auto& [edit, place] = GetParam();
  const std::string table = (folder / "table.toml").string();
  ASSERT_EQ(run("sed '" + std::string(edit) + "' " + frictional + " > " + table).code, 0);
  for (const char* question : {"chute", "plane_shear", "depth_for_flow", "simple_shear"}) {
    const Output output = predict(data + "/cases/" + question + ".toml -t " + table);
    EXPECT_EQ(output.code, 1) << question;
    EXPECT_NE(output.text.find(place), std::string::npos) << output.text;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Tables,
    ImpossibleCoefficient,
    ::testing::Values(std::pair("s/^mu_inf.*/beta = 1e300/; /^I_mu/d", "error: beta = 1e+300"),
                      std::pair("s/^I_mu.*/I_mu = 1e-300/",
                                "the slope of mu(I) at rest, (mu_inf - mu0)/I_mu"),
                      std::pair("s/^mu_inf/exponent = 1e-3\\nmu_inf/", "error: exponent = 0.001"),
                      std::pair("s/^phi0.*/phi0 = 1e-300/", "error: phi0 = 1e-300")));

TEST_F(PredictChute, CohesiveGrainsOnALawWithoutCohesionAreToldSo) {
  const std::string dry = (folder / "dry.toml").string();
  ASSERT_EQ(run("sed '/^.law.cohesion/,/^$/d' " + frictional + " > " + dry).code, 0);
  const std::string bagnold = data + "/tables/brewster2008_example.toml";
  const std::string cell = write(
      "units = \"grain\"\n[grains]\nadhesion = 1\n[geometry]\nkind = \"split_bottom\"\n"
      "split_radius = 40\ndepth = 10\nrotation_rate = 0.01\n");
  const std::string walls = data + "/cases/cohesive_walls.toml";
  const auto told = [](const std::string& question, const std::string& table) {
    const Output output = predict(question + " -t " + table + " --json");
    EXPECT_EQ(output.code, 0) << output.text;
    const auto json = nlohmann::json::parse(output.text);
    return json.contains("cohesion_text") &&
           json["cohesion_text"].get<std::string>().find("knows no cohesion") != std::string::npos;
  };
  EXPECT_TRUE(told(walls, dry));
  EXPECT_TRUE(told(walls, bagnold));
  EXPECT_TRUE(told(cell, dry));
  EXPECT_TRUE(told(data + "/cases/simple_shear.toml", dry));
  EXPECT_FALSE(told(walls, frictional));
  EXPECT_FALSE(told(data + "/cases/chute.toml", dry));
}

TEST_F(PredictChute, LayerBelowTheStopDepthIsFlaggedThin) {
  const auto thin = [&](const std::string& depth) {
    const Output output = predict(write("units = \"grain\"\nanswer = \"steady\"\n[chute]\n"
                                        "inclination = 21\ndepth = " +
                                        depth + "\n") +
                                  " --json --table " + frictional);
    return nlohmann::json::parse(output.text);
  };
  const double stop = thin("20")["stop_depth"].get<double>();
  EXPECT_EQ(thin(std::to_string(0.99 * stop))["thin"], true);
  EXPECT_EQ(thin(std::to_string(1.01 * stop))["thin"], false);
}

}  // namespace
}  // namespace grainlaw
