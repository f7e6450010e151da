#include <gtest/gtest.h>

#include <cmath>

#include "apps/io/local_data_hdf5.h"
#include "apps/study_kinds.h"
#include "apps/study_report.h"
#include "tests/apps/io/temporary_directory.h"
#include "tests/support/synthetic_chute.h"

namespace grainlaw::study {
namespace {

Point point(const std::string& setting, double cost, double error, double bar = nan) {
  Point result;
  result.quantity = result.series = "mu";
  result.setting = setting;
  result.cost = cost;
  result.error = error;
  result.error_bar = bar;
  return result;
}

TEST(Advice, TakesTheCheapestSettingThatIsSurelyGoodEnough) {
  const auto advice = advise(
      {point("coarse", 1.0, 0.009, 0.004), point("fine", 10.0, 0.002), point("finer", 100.0, 1e-4)},
      0.01);
  ASSERT_EQ(advice.size(), 1);
  EXPECT_NE(advice[0].find("use fine (10 CPU s; error 0.20 %)"), std::string::npos) << advice[0];
}

TEST(Advice, DoesNotPraiseWhatNoiseHides) {
  const auto advice = advise({point("noisy", 1.0, 0.012, 0.01)}, 0.01);
  EXPECT_NE(advice[0].find("too short to tell"), std::string::npos) << advice[0];
}

TEST(Advice, SaysThatNoSettingIsGoodEnough) {
  const auto advice = advise({point("a", 1.0, 0.5), point("b", 2.0, 0.2)}, 0.01);
  EXPECT_NE(advice[0].find("No setting reaches"), std::string::npos) << advice[0];
  EXPECT_NE(advice[0].find("b (2 CPU s), is off by 20 %"), std::string::npos) << advice[0];
}

TEST(StudyReport, DrawsAFailureOnTheTopEdgeAndKeepsItsReason) {
  Result result;
  result.points = {point("t/20", 1.0, 0.01), point("t/10", nan, nan)};
  result.points[1].failure = "refused, as \"unstable\"";
  const std::string script = plot_script(result);
  EXPECT_NE(script.find("$failures"), std::string::npos);
  EXPECT_NE(script.find("pt 2"), std::string::npos) << "a cross";
  EXPECT_NE(csv_text(result).find("\"refused, as \"\"unstable\"\"\""), std::string::npos);
  EXPECT_NE(markdown_text(result).find("no result: refused"), std::string::npos);
}

TEST(StudyReport, TellsLinesApartByTheirShapes) {
  Result result;
  for (int k = 0; k < 8; ++k) {
    result.points.push_back(point("x", 1.0 + k, 0.1));
    result.points.back().series = std::string(1, static_cast<char>('a' + k));
  }
  const std::string script = plot_script(result);
  for (const int shape : {4, 5, 6, 7, 8, 9, 11, 12}) {
    EXPECT_NE(script.find("linespoints pt " + std::to_string(shape) + " "), std::string::npos)
        << shape;
  }
}

TEST(CostLog, AddsTheSessionsOfARunAndRemembersThem) {
  const io::TemporaryDirectory folder;
  {
    CostLog log(folder / "cpu.csv");
    log.begin("run");
    log.add("run", 2.0, false);
    log.add("run", 3.0, true);
  }
  const CostLog log(folder / "cpu.csv");
  EXPECT_TRUE(log.finished("run"));
  EXPECT_FALSE(log.finished("other"));
  EXPECT_DOUBLE_EQ(log.cpu_seconds("run"), 5.0);
}

io::StudyFile quick() {
  io::StudyFile file;
  file.repeats = 1;
  return file;
}

std::vector<Point> of_series(const Result& result, const std::string& series) {
  std::vector<Point> points;
  for (const Point& one : result.points) {
    if (one.series == series) points.push_back(one);
  }
  return points;
}

constexpr const char* bagnold_table = R"(units = "grain"
[law]
closure = "bagnold"
a = 26.0
b = 0.0
volume_fraction = 0.58
inclination = 23.0
)";
constexpr const char* bagnold_chute = R"(units = "grain"
[chute]
inclination = 23.0
mass_per_area = 30.0
)";

// The second order of the grid is that of Bagnold flow (continuum/chute_1d.h): between 50 and 100
// cells four times less error; the next order of h^2 expansions changes it by O(1/cells).
TEST(SolverStudy, ErrorFallsAsTheSquareOfTheCells) {
  const io::TemporaryDirectory folder;
  io::SolverStudy study{.question = folder.write("case.toml", bagnold_chute),
                        .table = folder.write("table.toml", bagnold_table),
                        .cells = {50, 100},
                        .tolerances = {1e-8},
                        .regularisations = {}};
  const Result result = run(study, quick(), Context{});
  const auto points = of_series(result, "scaled rate, rtol 1e-08");
  ASSERT_EQ(points.size(), 2);
  EXPECT_NEAR(std::log2(points[0].error / points[1].error), 2.0, 0.1);
  EXPECT_GT(points[1].cost, points[0].cost);
}

TEST(SolverStudy, ARegularisationBelowWhatTheToleranceResolvesIsAFailure) {
  const io::TemporaryDirectory folder;
  io::SolverStudy study{.question = folder.write("case.toml", bagnold_chute),
                        .table = folder.write("table.toml", bagnold_table),
                        .cells = {50},
                        .tolerances = {1e-6},
                        .regularisations = {1e-9}};
  const Result result = run(study, quick(), Context{});
  const auto points = of_series(result, "delta 1e-09, rtol 1e-06");
  ASSERT_EQ(points.size(), 1);
  EXPECT_TRUE(points[0].failed());
}

std::filesystem::path store(const io::TemporaryDirectory& folder, const dem::LocalData& data) {
  const std::filesystem::path path = folder / (data.name + ".h5");
  io::write_local_data(data, io::SceneFile{}, path);
  return path;
}

// Every frame adds its own velocity to the whole layer: stretches of n frames scatter by
// 1/sqrt(n). The root mean square of 16 is known to 1/sqrt(30).
TEST(AveragingTimeStudy, IndependentFramesScatterWithTheInverseRootOfTheTime) {
  const io::TemporaryDirectory folder;
  grainlaw::testing::SyntheticChute chute{.velocity_noise = 0.5, .frames = 320};
  const dem::LocalData data = grainlaw::testing::local_data(chute);
  const io::AveragingTimeStudy study{.source = {.run = store(folder, data), .scene = {}},
                                     .reference_seeds = {}};
  const Result result = run(study, quick(), Context{});
  const auto points = of_series(result, "mean velocity");
  ASSERT_EQ(points.size(), 4) << "the whole run has nothing to be held against";
  double mean = 0.0;
  for (const dem::ProfileFrame& frame : data.frames.frames) {
    mean += dem::mean_velocity(frame) / static_cast<double>(data.frames.frames.size());
  }
  const double expected = chute.velocity_noise / std::sqrt(20.0) / mean;
  EXPECT_NEAR(points[0].error, expected, 3.0 * expected / std::sqrt(30.0));
  const auto claimed = of_series(result, "mean velocity, claimed");
  ASSERT_EQ(claimed.size(), 5);
  EXPECT_NEAR(claimed[4].error, expected / 4.0, 0.7 * expected / 4.0)
      << "standard errors of block averages hold to 0.7-1.4";
}

dem::LocalData chute_of_law(double degrees, std::uint64_t seed) {
  constexpr double mu0 = 0.36, beta = 0.6;  // mu = mu0 + beta I
  const double tilt = degrees * std::numbers::pi / 180.0;
  const double I = (std::tan(tilt) - mu0) / beta;
  grainlaw::testing::SyntheticChute chute{
      .name = "theta" + std::to_string(static_cast<int>(degrees)),
      .inclination = tilt,
      .a = grainlaw::testing::bagnold_coefficient(I, tilt),
      .velocity_noise = 0.02,
      .seed = seed};
  return grainlaw::testing::local_data(chute);
}

TEST(LawStudy, ALawOfIPredictsAnotherTiltWhereBagnoldKeepsItsCoefficient) {
  const io::TemporaryDirectory folder;
  io::LawStudy study;
  for (const int degrees : {22, 24, 27}) {
    study.fitted.push_back(store(folder, chute_of_law(degrees, 10U + unsigned(degrees))));
  }
  study.predicted.push_back(store(folder, chute_of_law(25, 3)));
  const Result result = run(study, quick(), Context{});
  const auto points = of_series(result, "velocity of theta25");
  ASSERT_EQ(points.size(), 6);
  EXPECT_EQ(points[0].setting, "Bagnold");
  EXPECT_EQ(points[2].setting, "mu(I)");
  // I goes from 0.142 (24 degrees) to 0.177 (25 degrees): a velocity of the nearest tilt is off by
  // a fifth; the law of I is the one the runs were made of.
  EXPECT_GT(points[0].error, 0.1);
  EXPECT_LT(points[2].error, 0.01);
  EXPECT_TRUE(points[4].failed()) << "nothing attracts, so no term in Bo can be told";
  EXPECT_TRUE(points[5].failed()) << "no shear band gives a nonlocal amplitude";
}

}  // namespace
}  // namespace grainlaw::study
