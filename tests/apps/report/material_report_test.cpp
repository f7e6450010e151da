// The part of a report on material laws, from boxes of known stress instead of DEM.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/friction_tables.h"
#include "apps/io/rheology_table_toml.h"
#include "apps/io/safe_write.h"
#include "apps/material_runs.h"
#include "tests/support/synthetic_box.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::SyntheticBox;

/// Boxes on the published law of frictional grains (Shi et al. 2020), with noise; one drifts.
std::vector<dem::LocalData> boxes(const continuum::RheologyTable& table) {
  const auto& law = std::get<continuum::MuPhi>(table.law);
  std::vector<dem::LocalData> runs;
  const auto add = [&](double I, double p, double Bo) {
    const continuum::Confinement at{.softness = (1.0 + Bo) * p, .bond_number = Bo};
    runs.push_back(testing::local_data({.name = "box" + std::to_string(runs.size()) + "<&>",
                                        .inertial_number = I,
                                        .softness = p,
                                        .bond_number = Bo,
                                        .friction = continuum::friction(law, I, at),
                                        .volume_fraction = continuum::volume_fraction(law, I, at),
                                        .friction_noise = 0.03,
                                        .fraction_noise = 0.003,
                                        .frames = 320,
                                        .seed = runs.size() + 1}));
  };
  for (const double p : {0.0025, 0.005, 0.01, 0.02}) {
    for (const double I : {0.01, 0.05, 0.1, 0.2, 0.4}) add(I, p, 0.0);
  }
  for (const double Bo : {0.5, 1.0, 2.0, 3.0, 5.0}) add(0.05, 0.01, Bo);
  add(0.1, 0.005, 0.0);
  runs.back().window = {false, 0.0, 320.0, "drifting"};
  return runs;
}

class MaterialReportTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::temp_directory_path() / "grainlaw-material-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory = pattern;
    const fs::path row = fs::path(GRAINLAW_DATA) / "tables" / "shi2020_mu_p_0.50.toml";
    report::Report report;
    report.title = "Simple shear";
    report.material = study_material(boxes(io::read_table(row)), {});
    report.material->reference = io::read_table(row);
    report.material->reference_name = row.stem().string();
    report.table = report.material->fit.table;
    material = *report.material;
    report::write_report(report, directory);
    html = io::read_file(directory / "report.html");
    numbers = json::parse(io::read_file(directory / "report.json"));
  }
  static void TearDownTestSuite() { fs::remove_all(directory); }

  static bool shows(const std::string& text) { return html.find(text) != std::string::npos; }

  static inline fs::path directory;
  static inline std::string html;
  static inline json numbers;
  static inline report::MaterialReport material;
};

TEST_F(MaterialReportTest, LawTheBoxesWereMadeOfComesBackWithinItsErrors) {
  // Four standard errors: one false alarm in 16 000 for each coefficient.
  const auto reference = *material.reference;
  for (const auto* fit : {&material.fit.friction, &material.fit.volume_fraction}) {
    for (const auto& c : fit->coefficients) {
      EXPECT_NEAR(c.value, continuum::coefficient(reference, c.name), 4.0 * c.error) << c.name;
    }
  }
}

TEST_F(MaterialReportTest, BandsHoldTheLawTheyWereDrawnAbout) {
  ASSERT_EQ(material.against_inertia.size(), 4u);
  ASSERT_EQ(material.against_cohesion.size(), 1u);
  for (const report::LawLine& line : material.against_inertia) {
    ASSERT_TRUE(line.band);
    for (std::size_t k = 0; k < line.states.size(); ++k) {
      EXPECT_LT(line.band->friction.lower[k], line.band->friction.upper[k]);
    }
  }
}

TEST_F(MaterialReportTest, PageShowsPublishedRowFamiliesAndThePointLeftOut) {
  EXPECT_TRUE(shows("shi2020_mu_p_0.50"));
  EXPECT_TRUE(shows("Families of the friction law"));
  EXPECT_TRUE(shows("box25&lt;&amp;&gt; is left out: not steady: drifting"));
  EXPECT_FALSE(shows("id=\"predictions\""));  // no chute, no empty part about chutes
  EXPECT_FALSE(shows("box1<&>"));
}

TEST_F(MaterialReportTest, EveryFigureIsDrawnWhereGnuplotIsInstalled) {
  if (std::system("command -v gnuplot > /dev/null") != 0) GTEST_SKIP();
  EXPECT_FALSE(shows("Figures are missing"));
  for (const char* figure : {"material_friction",
                             "material_volume_fraction",
                             "material_friction_cohesion",
                             "material_volume_fraction_cohesion",
                             "material_residuals",
                             "material_cost_mu",
                             "material_cost_phi"}) {
    EXPECT_TRUE(fs::exists(directory / "plots" / (std::string(figure) + ".svg"))) << figure;
  }
}

TEST_F(MaterialReportTest, JsonHoldsPointsInformationAndCost) {
  const json& part = numbers["material"];
  EXPECT_EQ(part["points"].size(), 26u);
  EXPECT_EQ(part["points"][25]["unfit"], "not steady: drifting");
  EXPECT_EQ(part["friction_information"]["runs"].size(), 25u);
  ASSERT_EQ(part["cost"].size(), 5u);
  EXPECT_DOUBLE_EQ(part["cost"][4]["dem_wall_seconds"], 26.0 * 10.0);
  EXPECT_EQ(part["reference"]["name"], "shi2020_mu_p_0.50");
  EXPECT_EQ(part["families"].size(), 8u);
}

TEST(FrictionTablesProgram, TableInBetweenFollowsFromTheShippedRows) {
  std::string pattern = (fs::temp_directory_path() / "grainlaw-tables-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  FrictionTables arguments{.tables = {}, .output = pattern, .contact_friction = 0.3};
  const fs::path tables = fs::path(GRAINLAW_DATA) / "tables";
  for (const char* row : {"mu_p_0.00",
                          "mu_p_0.01",
                          "phi_mu_p_0.05",
                          "phi_mu_p_0.10",
                          "phi_mu_p_0.20",
                          "phi_mu_p_0.40",
                          "mu_p_0.50",
                          "phi_mu_p_0.70",
                          "phi_mu_p_0.90",
                          "phi_mu_p_1.00"}) {
    arguments.tables.push_back((tables / (std::string("shi2020_") + row + ".toml")).string());
  }
  EXPECT_EQ(fit_over_contact_friction(arguments, {.quiet = true}), ExitCode::answered);
  const auto table = io::read_table(fs::path(pattern) / "table.toml");
  const auto left_out = io::read_table(tables / "shi2020_phi_mu_p_0.30.toml");
  EXPECT_DOUBLE_EQ(table.contact_friction, 0.3);
  // The row that was not fitted, within what leaving out any other row says of interpolation.
  for (const std::string& name : continuum::coefficient_names(table)) {
    const auto& names = table.covariance->names;
    const auto k =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    EXPECT_NEAR(continuum::coefficient(table, name),
                continuum::coefficient(left_out, name),
                std::sqrt((*table.covariance)(k, k)))
        << name;
  }
  const json numbers = json::parse(io::read_file(fs::path(pattern) / "report.json"));
  EXPECT_EQ(numbers["contact_friction"]["curves"].size(), 7u);
  fs::remove_all(pattern);
}

}  // namespace
}  // namespace grainlaw
