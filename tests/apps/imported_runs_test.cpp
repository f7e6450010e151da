// Runs of other programs, from their files to tables and reports.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace {

namespace fs = std::filesystem;

struct Output {
  int code = -1;
  std::string text;  ///< stdout
};

Output grainlaw(const std::string& arguments) {
  Output output;
  const std::string command = std::string(GRAINLAW_BIN) + "/grainlaw " + arguments;
  FILE* pipe = popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    output.text.append(buffer.data(), n);
  }
  const int status = pclose(pipe);
  output.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return output;
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
  const Output fit = grainlaw("calibrate " + data_ + "/campaigns/imported/campaign.toml --from" +
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
  const Output again = grainlaw("compare " + (folder_ / "runs/lammps-25.h5").string() + " -t " +
                                (folder_ / "table.toml").string() + " --json -o " +
                                (folder_ / "comparison").string());
  ASSERT_EQ(again.code, 0) << again.text;
  EXPECT_TRUE(nlohmann::json::parse(again.text)["lammps-25"].contains("value"));
}

TEST_F(ImportedRuns, ProfilesOfLammpsAreComparedWithATable) {
  const Output compared = grainlaw("compare " + data_ + "/imports/lammps_chute_kn2e4.toml " +
                                   data_ + "/imports/lammps_chute_kn2e5.toml -t " + data_ +
                                   "/tables/shi2020_mu_p_0.50.toml --json -o " + folder_.string());
  ASSERT_EQ(compared.code, 0) << compared.text;
  const auto json = nlohmann::json::parse(compared.text);
  EXPECT_TRUE(json["lammps-kn2e4"].contains("value"));
  EXPECT_NE(json["lammps-kn2e5_steadiness"].get<std::string>().find("averages only"),
            std::string::npos);
}

}  // namespace
