// The programs as a person meets them: exit codes, messages, files.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/shell.h"

namespace {

namespace fs = std::filesystem;

using Output = grainlaw::testing::CommandOutput;
const auto run = grainlaw::testing::run_command;

const std::string bin = GRAINLAW_BIN;
const std::string data = GRAINLAW_DATA;
const std::string published = " --table " + data + "/tables/shi2020_mu_p_0.50.toml";

Output grainlaw(const std::string& arguments) {
  return run(bin + "/grainlaw " + arguments);
}

class Programs : public testing::Test {
 protected:
  Programs() { fs::create_directories(folder_); }
  ~Programs() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }
  /// Twenty square diameters, five deep: seconds, not minutes.
  std::string small_scene(const std::string& tilt,
                          const std::string& more = {},
                          const std::string& size = "length = 5\nwidth = 4\ndepth = 5") const {
    return write("scene.toml",
                 "name = \"small\"\nunits = \"grain\"\n"
                 "[contact.normal]\nlaw = \"hooke\"\nstiffness = 2e4\nrestitution = 0.88\n"
                 "[contact.friction]\nlaw = \"sliding\"\ncoefficient = 0.5\n"
                 "[geometry]\nkind = \"chute\"\ninclination = " +
                     tilt + "\n" + size +
                     "\n"
                     "[measurement]\naveraging_time = 40\ntime_limit = 400\n" +
                     more);
  }
  std::string chute_case(const std::string& tilt, const std::string& more = {}) const {
    return write(
        "case.toml",
        "units = \"grain\"\n" + more + "[chute]\ninclination = " + tilt + "\nmass_per_area = 30\n");
  }

 private:
  fs::path folder_ = fs::temp_directory_path() / ("grainlaw-programs-" + std::to_string(getpid()));
};

TEST_F(Programs, EveryVerbHelpsWithAnExample) {
  for (const char* verb : {"dem", "calibrate", "predict", "compare", "study"}) {
    const Output help = grainlaw(std::string(verb) + " --help");
    EXPECT_EQ(help.code, 0) << verb;
    EXPECT_NE(help.text.find("Example"), std::string::npos) << verb;
    EXPECT_NE(help.text.find("grainlaw " + std::string(verb)), std::string::npos) << verb;
  }
}

TEST_F(Programs, AnUnknownVerbOrOptionIsAUsageError) {
  EXPECT_EQ(grainlaw("fly").code, 1);
  EXPECT_EQ(grainlaw("").code, 1);
  EXPECT_EQ(grainlaw("dem --sideways").code, 1);
}

TEST_F(Programs, PredictLinksNeitherCeresNorHdf5NorDem) {
  const Output libraries = run("ldd " + bin + "/grainlaw-predict");
  ASSERT_EQ(libraries.code, 0);
  EXPECT_EQ(libraries.text.find("ceres"), std::string::npos);
  EXPECT_EQ(libraries.text.find("hdf5"), std::string::npos);
  const Output symbols = run("nm -C " + bin + "/grainlaw-predict");
  ASSERT_EQ(symbols.code, 0);
  EXPECT_EQ(symbols.text.find("grainlaw::dem"), std::string::npos);
}

TEST_F(Programs, PredictAnswersSteadyAsJson) {
  const Output answer = grainlaw("predict " + chute_case("24") + published + " --json");
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto json = nlohmann::json::parse(answer.text);
  EXPECT_EQ(json["outcome"], "STEADY");
  EXPECT_GT(json["surface_velocity"]["value"].get<double>(), 0.0);
}

TEST_F(Programs, ALayerBelowReposeArrestsAndASteepOneHasNoSteadyState) {
  const Output flat = grainlaw("predict " + chute_case("15") + published);
  EXPECT_EQ(flat.code, 2);
  EXPECT_NE(flat.text.find("ARRESTED"), std::string::npos) << flat.text;
  const Output steep = grainlaw("predict " + chute_case("40") + published);
  EXPECT_EQ(steep.code, 2);
  EXPECT_NE(steep.text.find("NO_STEADY"), std::string::npos) << steep.text;
  const Output thin = grainlaw("predict " + chute_case("34.5") + published);
  EXPECT_EQ(thin.code, 2);
  EXPECT_NE(thin.text.find("NO_DENSE_STATE"), std::string::npos) << thin.text;
}

TEST_F(Programs, StartFromRestAgreesWithTheQuadrature) {
  const Output answer =
      grainlaw("predict " + chute_case("24", "answer = \"start\"\n") + published + " --json");
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto json = nlohmann::json::parse(answer.text);
  const double steady = json["surface_velocity"]["value"];
  const double transient = json["transient_surface_velocity"];
  // 200 cells: the grid error of this law is 5e-6 of the surface velocity at 200 cells.
  EXPECT_NEAR(transient / steady, 1.0, 2e-5);
}

TEST_F(Programs, PredictWritesProfilesAsCsvAndJson) {
  const std::string question = chute_case("24");
  EXPECT_EQ(grainlaw("predict " + question + published + " -o " + path("p.csv")).code, 0);
  EXPECT_EQ(grainlaw("predict " + question + published + " -o " + path("p.json")).code, 0);
  EXPECT_GT(fs::file_size(path("p.csv")), 1000u);
  std::ifstream file(path("p.json"));
  EXPECT_TRUE(nlohmann::json::accept(file));
}

TEST_F(Programs, AMissingTableIsBadInput) {
  const Output answer = grainlaw("predict " + chute_case("24") + " --table " + path("none.toml"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("none.toml"), std::string::npos);
}

TEST_F(Programs, AMisspeltKeyIsShownWithItsNearest) {
  const std::string scene = small_scene("24", "[time]\nstepp = 1e-4\n");
  const Output answer = grainlaw("dem " + scene);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("scene.toml:20:1"), std::string::npos) << answer.text;
  EXPECT_NE(answer.text.find("did you mean 'step'"), std::string::npos) << answer.text;
}

TEST_F(Programs, CheckSaysWhatWouldRunAndRunsNothing) {
  const std::string scene = small_scene("24");
  const Output answer = grainlaw("dem " + scene + " --check -o " + path("out.h5"));
  EXPECT_EQ(answer.code, 0) << answer.text;
  EXPECT_NE(answer.text.find("leaves out"), std::string::npos);
  EXPECT_NE(answer.text.find("time step"), std::string::npos);
  EXPECT_FALSE(fs::exists(path("out.h5")));
}

TEST_F(Programs, AnUnstableStepIsRefusedUnlessAllowed) {
  const std::string scene = small_scene("24", "[time]\nstep = 2e-3\n");
  const Output refused = grainlaw("dem " + scene + " --check");
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.text.find("shortest contact time"), std::string::npos) << refused.text;
  EXPECT_EQ(grainlaw("dem " + scene + " --check --allow-step").code, 0);
}

TEST_F(Programs, TheSameSceneGivesTheSameNumbers) {
  const std::string scene = small_scene("24");
  const Output first = grainlaw("dem " + scene + " --json -o " + path("a.h5"));
  const Output second = grainlaw("dem " + scene + " --json -o " + path("b.h5"));
  auto a = nlohmann::json::parse(first.text.substr(first.text.find('{')));
  auto b = nlohmann::json::parse(second.text.substr(second.text.find('{')));
  for (auto* json : {&a, &b}) {
    json->erase("wall_seconds");
    json->erase("grain_steps_per_second");
    json->erase("output");
  }
  EXPECT_EQ(a, b);
}

TEST_F(Programs, ARunIsDrawnOnRequest) {
  const std::string run_scene = "dem " + small_scene("24") + " --quiet -o " + path("drawn.h5");
  const Output picture = grainlaw(run_scene + " --plot " + path("drawn.svg"));
  if (picture.text.find("gnuplot was not found") != std::string::npos) GTEST_SKIP();
  std::ifstream file(path("drawn.svg"));  // what was measured is drawn, steady or not
  ASSERT_TRUE(file) << picture.text;
  const std::string svg{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
  EXPECT_NE(svg.find("φ"), std::string::npos);
}

TEST_F(Programs, APictureThatCannotBeDrawnIsRefusedBeforeTheRun) {
  const std::string dem = "/grainlaw-dem " + small_scene("24") + " -o " + path("never.h5");
  const Output ending = run(bin + dem + " --plot " + path("p.pdf"));
  EXPECT_EQ(ending.code, 1);
  EXPECT_NE(ending.text.find(".svg or .png"), std::string::npos) << ending.text;
  const Output none = run("PATH=/nowhere " + bin + dem + " --plot " + path("p.svg"));
  EXPECT_EQ(none.code, 1);
  EXPECT_NE(none.text.find("gnuplot was not found"), std::string::npos) << none.text;
  EXPECT_FALSE(fs::exists(path("never.h5")));
}

TEST_F(Programs, AnEmptyNameIsNoOutput) {
  const Output empty = grainlaw("dem " + small_scene("24") + " --check -o ''");
  EXPECT_EQ(empty.code, 1);
  EXPECT_NE(empty.text.find("empty"), std::string::npos) << empty.text;
}

TEST_F(Programs, ALayerThatStaysAtRestEndsWithItsReason) {
  const Output answer = grainlaw("dem " + small_scene("15") + " --quiet -o " + path("rest.h5"));
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.text.find("arrested"), std::string::npos) << answer.text;
  EXPECT_TRUE(fs::exists(path("rest.h5")));
}

TEST_F(Programs, ArrestAfterATiltIsAnAnswerWithItsTime) {
  const std::string laid_back = "\ntilt_times = [30.0]\ntilts = [12.0]";
  const std::string scene = small_scene("26" + laid_back);
  const Output answer = grainlaw("dem " + scene + " --json -o " + path("laid.h5"));
  EXPECT_EQ(answer.code, 0) << answer.text;
  const auto json = nlohmann::json::parse(answer.text.substr(answer.text.find('{')));
  EXPECT_FALSE(json["steady"].get<bool>());
  EXPECT_GT(json["arrested_at"].get<double>(), 30.0);
  EXPECT_EQ(json["inclination"].get<double>(), 12.0);
}

TEST_F(Programs, TiltsAndTheirTimesHaveToBeEquallyMany) {
  const Output answer = grainlaw("dem " + small_scene("26\ntilts = [12.0]") + " --check");
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("equally long"), std::string::npos) << answer.text;
}

TEST_F(Programs, ASteepLayerIsCalledAcceleratingBeforeItsTimeIsUp) {
  const Output answer = grainlaw("dem " + small_scene("40") + " --quiet -o " + path("steep.h5"));
  EXPECT_EQ(answer.code, 2);
  EXPECT_NE(answer.text.find("accelerating"), std::string::npos) << answer.text;
}

TEST_F(Programs, ADepthBecomesTheMassThatStandsThatHigh) {
  const std::string question =
      write("deep.toml", "units = \"grain\"\n[chute]\ninclination = 24\ndepth = 35.5\n");
  const Output answer = grainlaw("predict " + question + published + " --json");
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_NEAR(nlohmann::json::parse(answer.text)["height"].get<double>(), 35.5, 1e-8);
}

TEST_F(Programs, OutputTimesAreAnswered) {
  const std::string question =
      chute_case("24", "answer = \"start\"\n") + " --json -o " + path("start.csv");
  std::ofstream(path("case.toml"), std::ios::app) << "[transient]\noutput_times = [5.0, 20.0]\n";
  const Output answer = grainlaw("predict " + question + published);
  ASSERT_EQ(answer.code, 0) << answer.text;
  const auto json = nlohmann::json::parse(answer.text);
  EXPECT_LT(json["surface_velocity_at_5"], json["surface_velocity_at_20"]);
  EXPECT_TRUE(fs::exists(path("start_t5.csv")) && fs::exists(path("start_t20.csv")));
}

TEST_F(Programs, AnInputIsNeverOverwritten) {
  const std::string question = chute_case("24", "answer = \"start\"\n");
  std::ofstream(question, std::ios::app) << "[transient]\noutput_times = [5.0]\n";
  for (const char* name : {"table.toml", "profile_t5.csv", "other.toml"})
    fs::copy_file(data + "/tables/shi2020_mu_p_0.50.toml", path(name));
  const auto refused = [&](const std::string& table, const std::string& output) {
    const Output answer = grainlaw("predict " + question + " -t " + table + " -o " + output);
    return answer.code == 1 && answer.text.find("overwritten") != std::string::npos;
  };
  const std::string table = path("table.toml");
  EXPECT_TRUE(refused(table, question));
  EXPECT_TRUE(refused(table, table));
  EXPECT_TRUE(refused(path("profile_t5.csv"), path("profile.csv")));  // by a snapshot
  EXPECT_TRUE(refused(table, path("other.toml")));                    // an input of another day
}

TEST_F(Programs, ARunIsNeverOverwrittenByAProfile) {
  const std::string run_file = write("run.h5", "\x89HDF and hours of DEM");
  const Output answer = grainlaw("predict " + chute_case("24") + published + " -o " + run_file);
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("HDF5"), std::string::npos) << answer.text;
}

TEST_F(Programs, AnErrorThatIsNotKnownIsNull) {
  const Output answer = grainlaw("predict " + chute_case("24") + published + " --json");
  ASSERT_EQ(answer.code, 0) << answer.text;
  EXPECT_TRUE(nlohmann::json::parse(answer.text)["surface_velocity"]["error"].is_null());
}

TEST_F(Programs, AClosedStderrIsNoReasonToCrash) {
  EXPECT_EQ(run("(" + bin + "/grainlaw predict " + chute_case("15") + published + " 2>&-)").code,
            2);
  EXPECT_EQ(run("(" + bin + "/grainlaw fly 2>/dev/full)").code, 1);
}

/// A campaign of small chutes, calibrated once for several questions.
class Campaign : public Programs {
 protected:
  Output calibrate(const std::string& more) const {
    return grainlaw("calibrate " + campaign_ + " --json -o " + path("report") + more);
  }
  std::string run_file(const std::string& tilt) const {
    return path("report/runs/theta" + tilt + ".h5");
  }
  /// Without the warnings before it.
  static nlohmann::json summary_of(const Output& answer) {
    return nlohmann::json::parse(answer.text.substr(answer.text.find("\n{") + 1));
  }
  /// Joined frames hold the same means in fewer blocks, so a fit weighs its rows a little
  /// differently: within a tenth of its standard errors. Both files count as the same run.
  void reduce_and_fit_again(const nlohmann::json& whole) const {
    std::string small_files;
    for (const std::string tilt : {"25", "27"}) {
      const std::string small = path("small" + tilt + ".h5");
      const Output reduced = grainlaw("dem " + run_file(tilt) + " --reduce --json -o " + small);
      ASSERT_EQ(reduced.code, 0) << reduced.text;
      EXPECT_LT(2 * fs::file_size(small), fs::file_size(run_file(tilt)));
      small_files += " " + small;
    }
    const Output answer = calibrate(" --from" + small_files);
    ASSERT_EQ(answer.code, 0) << answer.text;
    const auto again = summary_of(answer);
    for (const std::string name : {"mu0", "beta", "phi0", "I_phi"}) {
      const double error = whole.at(name).at("error");
      EXPECT_NEAR(again.at(name).at("value").get<double>(),
                  whole.at(name).at("value").get<double>(),
                  0.1 * error)
          << name;
    }
    EXPECT_EQ(calibrate(" --from" + small_files + " " + run_file("25")).code, 1);
  }

 private:
  std::string campaign_ = [this] {
    small_scene("26", {}, "length = 6\nwidth = 6\ndepth = 7");  // smaller layers come to rest
    return write("campaign.toml",
                 "title = \"small\"\nscene = \"scene.toml\"\n"
                 "[tilts]\ncalibrate = [25.0, 27.0]\npredict = [26.0]\n");
  }();
};

TEST_F(Campaign, GoesTheWholeWayAndRefusesRunsThatAreNotItsOwn) {
  const Output whole = calibrate("");
  ASSERT_EQ(whole.code, 0) << whole.text;
  for (const char* file : {"report.html", "report.json", "table.toml", "predictions/theta26.csv"}) {
    EXPECT_TRUE(fs::exists(path("report/" + std::string(file)))) << file;
  }
  std::ifstream report(path("report/report.json"));
  EXPECT_TRUE(nlohmann::json::accept(report));

  const std::string fitted = " --from " + run_file("25") + " " + run_file("27");
  const Output twice = calibrate(fitted + " " + run_file("25"));
  EXPECT_EQ(twice.code, 1);
  EXPECT_NE(twice.text.find("twice"), std::string::npos) << twice.text;

  reduce_and_fit_again(summary_of(calibrate(fitted)));

  const Output compared = grainlaw("compare " + run_file("26") + " --table " +
                                   path("report/table.toml") + " -o " + path("compared"));
  EXPECT_EQ(compared.code, 0) << compared.text;
  const Output other = grainlaw("compare " + run_file("26") + " --table " + data +
                                "/tables/shi2020_mu_p_0.01.toml -o " + path("compared"));
  EXPECT_NE(other.text.find("contact friction 0.5"), std::string::npos) << other.text;
}

TEST_F(Programs, AFolderThatCannotBeWrittenIsAResourceError) {
  const Output answer =
      grainlaw("predict " + chute_case("24") + published + " -o /proc/none/profile.csv");
  EXPECT_EQ(answer.code, 3);
  EXPECT_NE(answer.text.find("/proc/none"), std::string::npos) << answer.text;
}

TEST_F(Programs, ABrokenLocalDataFileIsBadInput) {
  const std::string broken = write("broken.h5", "this is no HDF5 file");
  const Output answer = grainlaw("compare " + broken + published + " -o " + path("out"));
  EXPECT_EQ(answer.code, 1);
  EXPECT_NE(answer.text.find("broken.h5"), std::string::npos) << answer.text;
}

}  // namespace
