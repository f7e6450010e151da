// Runs of other programs, from their files to tables and reports.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

/// Its text is stdout.
grainlaw::testing::CommandOutput run_grainlaw(const std::string& arguments) {
  return grainlaw::testing::run_command(GRAINLAW_BIN "/grainlaw " + arguments + " 2>/dev/null");
}

class ImportedRuns : public testing::Test {
 protected:
  ~ImportedRuns() override { fs::remove_all(folder_); }

  const std::string data_ = GRAINLAW_DATA;
  const fs::path folder_ =
      fs::temp_directory_path() / ("grainlaw-imported-" + std::to_string(getpid()));
};

TEST_F(ImportedRuns, OfLammpsAreFittedPredictedAndStored) {
  std::string runs;
  for (const char* tilt : {"24", "25", "26"}) {
    runs += " " + data_ + "/imports/lammps_thin_chute_" + tilt + ".toml";
  }
  const auto fit = run_grainlaw("calibrate " + data_ + "/campaigns/imported/campaign.toml --from" +
                                runs + " --json -o " + folder_.string());
  ASSERT_EQ(fit.code, 0) << fit.text;
  const auto json = nlohmann::json::parse(fit.text);
  EXPECT_NE(json["lammps-25_weight"].get<std::string>().find("passed"), std::string::npos);
  // The stress ratio of a layer in balance: tan(24) to tan(26 degrees), so mu0 lies below.
  EXPECT_GT(json["mu0"]["value"].get<double>(), 0.3);
  EXPECT_LT(json["mu0"]["value"].get<double>(), 0.4452);
  for (const char* file : {"table.toml", "report.html", "runs/lammps-25.h5"}) {
    EXPECT_TRUE(fs::exists(folder_ / file)) << file;
  }
  std::ifstream file(folder_ / "report.json");
  const auto report = nlohmann::json::parse(file);
  EXPECT_NE(report["command"].get<std::string>().find(" --from " + data_), std::string::npos);
  for (const auto& cost : report["costs"]) EXPECT_TRUE(cost["cpu_seconds"].is_null()) << cost;
  const auto again = run_grainlaw("compare " + (folder_ / "runs/lammps-25.h5").string() + " -t " +
                                  (folder_ / "table.toml").string() + " --json -o " +
                                  (folder_ / "comparison").string());
  ASSERT_EQ(again.code, 0) << again.text;
  EXPECT_TRUE(nlohmann::json::parse(again.text)["lammps-25"].contains("value"));
}

TEST_F(ImportedRuns, ProfilesOfLammpsAreComparedWithATable) {
  const auto compared =
      run_grainlaw("compare " + data_ + "/imports/lammps_chute_kn2e4.toml " + data_ +
                   "/imports/lammps_chute_kn2e5.toml -t " + data_ +
                   "/tables/shi2020_mu_p_0.50.toml --json -o " + folder_.string());
  ASSERT_EQ(compared.code, 0) << compared.text;
  const auto json = nlohmann::json::parse(compared.text);
  EXPECT_TRUE(json["lammps-kn2e4"].contains("value"));
  EXPECT_NE(json["lammps-kn2e5_steadiness"].get<std::string>().find("averages only"),
            std::string::npos);
}

}  // namespace
