#include "apps/report/report.h"

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "apps/io/safe_write.h"
#include "tests/apps/report/synthetic_report.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::synthetic_report;

/// A folder of its own for every test, removed at its end.
class Report : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "grainlaw-report-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  template <class AnyReport>
  std::string write(const AnyReport& content) const {
    report::write_report(content, directory_);
    return io::read_file(directory_ / "report.html");
  }
  json numbers() const { return json::parse(io::read_file(directory_ / "report.json")); }
  fs::path plot(const std::string& name) const { return directory_ / "plots" / name; }

  fs::path directory_;
};

/// The synthetic report, written once for all tests that only read it.
class WrittenReport : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (fs::temp_directory_path() / "grainlaw-report-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory = pattern;
    report::write_report(synthetic_report(), directory);
    html = io::read_file(directory / "report.html");
  }
  static void TearDownTestSuite() { fs::remove_all(directory); }

  static inline fs::path directory;
  static inline std::string html;
};

/// Search path without any program, as on a machine without gnuplot.
class EmptyPath {
 public:
  explicit EmptyPath(const fs::path& empty) : before_(getenv("PATH")) {
    setenv("PATH", empty.c_str(), 1);
  }
  ~EmptyPath() { setenv("PATH", before_.c_str(), 1); }

 private:
  std::string before_;
};

bool gnuplot_is_installed() {
  return std::system("command -v gnuplot > /dev/null") == 0;
}

/// First tag that does not close the one last opened; empty when every tag is closed in order.
std::string first_unbalanced_tag(const std::string& html) {
  const std::size_t body = html.find("<html");
  const std::regex tag(R"(<(/?)([a-zA-Z0-9]+)[^>]*?(/?)>)");
  std::vector<std::string> open;
  for (auto it = std::sregex_iterator(html.begin() + body, html.end(), tag);
       it != std::sregex_iterator();
       ++it) {
    const bool closes = (*it)[1].length() > 0;
    const bool empty = (*it)[3].length() > 0;
    if (!closes && !empty) open.push_back((*it)[2]);
    if (!closes) continue;
    if (open.empty() || open.back() != (*it)[2]) return (*it)[0];
    open.pop_back();
  }
  return open.empty() ? "" : open.back();
}

/// Every entry of an XML attribute in a text.
std::vector<std::string> attributes(const std::string& html, const std::string& name) {
  std::vector<std::string> values;
  const std::regex attribute("[ \n]" + name + "=\"([^\"]*)\"");
  for (auto it = std::sregex_iterator(html.begin(), html.end(), attribute);
       it != std::sregex_iterator();
       ++it) {
    values.push_back((*it)[1]);
  }
  return values;
}

/// The page without markup, as a reader meets it.
std::string shown_text(const std::string& html) {
  const std::string body = html.substr(html.find("<body>"));
  return std::regex_replace(body, std::regex("<[^>]*>"), " ");
}

bool shows_nan(const std::string& html) {
  return std::regex_search(shown_text(html), std::regex("\\b[Nn][Aa][Nn]\\b|\\binf\\b"));
}

TEST_F(WrittenReport, TagsAreBalancedAndNothingIsLoadedFromElsewhere) {
  EXPECT_EQ(first_unbalanced_tag(html), "");
  EXPECT_EQ(html.find("http:"), std::string::npos);
  EXPECT_EQ(html.find("https:"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<img"), std::string::npos);
  EXPECT_TRUE(attributes(html, "src").empty());
}

TEST_F(WrittenReport, EveryIdIsUniqueAndEveryInnerReferenceHasItsTarget) {
  const std::vector<std::string> ids = attributes(html, "id");
  const std::set<std::string> unique(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), unique.size());
  for (const std::string& target : attributes(html, "href")) {
    const bool inner = target.starts_with('#');
    EXPECT_TRUE(inner ? unique.contains(target.substr(1)) : fs::exists(directory / target))
        << target;
  }
}

TEST_F(WrittenReport, EveryFigureIsInThePageAndCanBeDrawnAgain) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  std::size_t scripts = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory / "plots")) {
    if (entry.path().extension() != ".gp") continue;
    ++scripts;
    EXPECT_TRUE(fs::exists(fs::path(entry.path()).replace_extension(".svg"))) << entry.path();
  }
  // Law 2; five steady runs 3 profiles and 3 figures in time each; error against time 3.
  EXPECT_EQ(scripts, 2u + 5u * (3u + 3u) + 3u);
  EXPECT_EQ(attributes(html, "role").size(), scripts);
  const fs::path svg = directory / "plots" / "law_friction.svg";
  const std::string first = io::read_file(svg);
  fs::remove(svg);
  const std::string command =
      "cd '" + (directory / "plots").string() + "' && gnuplot --default-settings law_friction.gp";
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(io::read_file(svg), first);
}

TEST_F(WrittenReport, FiguresTakeTheColourAndFontOfThePage) {
  const std::string figures = html.substr(html.find("<body>"));
  EXPECT_EQ(figures.find("black"), std::string::npos);
  EXPECT_EQ(figures.find("rgb(  0,   0,   0)"), std::string::npos);
  EXPECT_EQ(figures.find("font-family"), std::string::npos);
}

TEST_F(Report, WithoutGnuplotTablesAndDataAreThereAndThePageSaysSo) {
  const EmptyPath no_programs(directory_);
  const std::string html = write(synthetic_report());
  EXPECT_NE(html.find("gnuplot was not found"), std::string::npos);
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find("<table>"), std::string::npos);
  EXPECT_TRUE(fs::exists(plot("law_curve.csv")));
  EXPECT_TRUE(fs::exists(plot("law_friction.gp")));
  EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST_F(Report, AFailingGnuplotLeavesNoOldPictureInThePage) {
  write(synthetic_report());
  std::ofstream(directory_ / "gnuplot") << "#!/bin/sh\necho 'no terminal svg' >&2\nexit 1\n";
  fs::permissions(directory_ / "gnuplot", fs::perms::owner_all);
  const EmptyPath only_the_broken_one(directory_);
  const std::string html = write(synthetic_report());
  EXPECT_EQ(html.find("<svg"), std::string::npos);
  EXPECT_NE(html.find("gnuplot failed: no terminal svg"), std::string::npos);
}

TEST_F(WrittenReport, JsonHoldsTheNumbersOfTheReport) {
  const report::Report content = synthetic_report();
  const json document = json::parse(io::read_file(directory / "report.json"));
  EXPECT_EQ(document["title"], content.title);
  ASSERT_EQ(document["runs"].size(), content.runs.size());
  for (std::size_t k = 0; k < content.runs.size(); ++k) {
    const report::RunComparison& run = content.runs[k];
    const json& entry = document["runs"][k];
    EXPECT_EQ(entry["kind"], calibration::name(run.kind));
    EXPECT_EQ(entry["answer"]["outcome"], continuum::name(run.steady.answer.outcome));
    EXPECT_EQ(entry["error"].is_null(), !run.error.has_value());
    ASSERT_EQ(entry["measured_rows"].size(), run.data.rows.size());
    for (std::size_t i = 0; i < run.data.rows.size(); ++i) {
      EXPECT_EQ(entry["measured_rows"][i]["velocity"]["value"], run.data.rows[i].velocity.value);
    }
    if (!run.error) continue;
    EXPECT_EQ(entry["error"]["velocity"]["value"], run.error->velocity.value);
  }
  EXPECT_EQ(document["fit"]["friction"]["coefficients"][0]["value"], 0.362);
  EXPECT_EQ(document["error_against_time"][1]["law_error"],
            content.error_against_time[1].law_error);
}

TEST_F(Report, NumbersThatAreNotThereAreNullInJsonAndADashInThePage) {
  report::Report content = synthetic_report();
  content.runs[0].data.rows[3].velocity = {};
  content.runs[0].data.summary.energy_residual = NAN;
  content.runs[0].error->flux = {};
  content.fit->volume_fraction.coefficients[1].error = INFINITY;
  content.runs[3].own_bagnold->ratio_mid_depth = {};
  const std::string html = write(content);
  EXPECT_FALSE(shows_nan(html));
  EXPECT_TRUE(numbers()["runs"][0]["error"]["flux"]["value"].is_null());
  EXPECT_TRUE(numbers()["runs"][0]["dem"]["energy_residual"].is_null());
  EXPECT_EQ(io::read_file(plot("1_chute_21_0_dem.csv")).find("nan"), std::string::npos);
}

TEST_F(Report, TextFromOutsideIsEscapedEverywhere) {
  report::Report content = synthetic_report();
  const std::string hostile = R"(<b>&"it's"</b>)";
  content.title = hostile;
  content.command = hostile;
  content.machine = hostile;
  content.warnings = {hostile};
  content.table.base->recipe = hostile;
  content.fit->friction.not_identifiable = {hostile};
  content.costs[0].stage = hostile;
  for (report::RunComparison& run : content.runs) {
    run.data.name = hostile;
    run.data.window.reason = hostile;
    run.steady.answer.text = hostile;
    run.naive_source = hostile;
    run.foreign_bagnold_source = hostile;
  }
  for (calibration::FlowPoint& point : content.fit->points) point.name = hostile;
  const std::string html = write(content);
  EXPECT_EQ(html.find("<b>&"), std::string::npos);
  EXPECT_NE(html.find("&lt;b&gt;&amp;&quot;it&#39;s&quot;&lt;/b&gt;"), std::string::npos);
  EXPECT_EQ(first_unbalanced_tag(html), "");
  EXPECT_EQ(html.find("gnuplot failed"), std::string::npos);
}

TEST_F(WrittenReport, InSampleAndPredictedErrorsStandUnderTheirOwnHeadings) {
  const std::string shown = shown_text(html);
  const std::size_t in_sample = shown.find("In sample: the law was fitted to these runs");
  const std::size_t interpolation = shown.find("Predicted, interpolation");
  const std::size_t extrapolation = shown.find("Predicted, extrapolation");
  ASSERT_NE(extrapolation, std::string::npos);
  EXPECT_LT(in_sample, interpolation);
  EXPECT_LT(interpolation, extrapolation);
  EXPECT_NE(shown.find("2.14 ± 0.41 %", 0), std::string::npos);
  EXPECT_NE(shown.find("24.8°, predicted (interpolation)"), std::string::npos);
  EXPECT_NE(shown.find("at 27.5° (reached 0.264, data 0.0410 to 0.206)"), std::string::npos);
}

TEST_F(Report, ATableWithoutErrorsAndWithoutAFitIsReportedAsSuch) {
  report::Report content = synthetic_report();
  content.fit.reset();
  content.table.covariance.reset();
  content.table.provenance.source = "Shi et al. 2020";
  content.error_against_time.clear();
  const std::string html = write(content);
  EXPECT_NE(html.find("this table states no errors"), std::string::npos);
  EXPECT_FALSE(shows_nan(html));
  EXPECT_EQ(first_unbalanced_tag(html), "");
}

TEST_F(Report, AReportWithoutRunsIsStillAReport) {
  report::Report content = synthetic_report();
  content.runs.clear();
  const std::string html = write(content);
  EXPECT_EQ(first_unbalanced_tag(html), "");
  EXPECT_FALSE(shows_nan(html));
}

TEST_F(Report, AFolderThatCannotBeWrittenIsAFileError) {
  std::ofstream(directory_ / "file") << "no folder";
  EXPECT_THROW(report::write_report(synthetic_report(), directory_ / "file"), io::FileError);
  EXPECT_THROW(report::write_report(synthetic_report(), directory_ / "file" / "below"),
               io::FileError);
}

TEST_F(Report, ASeriesShowsItsRunsAndNoLaw) {
  report::SeriesReport series;
  series.title = "Stiffness";
  series.warnings = {"one run failed"};
  series.costs = {{"DEM", 10.0, 20.0}};
  series.contacts.points.push_back({.name = "soft", .series = "hooke", .stiffness = 2e3});
  series.contacts.left_out = {"stiff: too few long contacts"};
  const std::string html = write(series);
  for (const char* there : {"one run failed", "soft", "too few long contacts", "DEM"})
    EXPECT_NE(html.find(there), std::string::npos) << there;
  for (const char* absent : {"Well-posedness", "Steady profiles", "Law"})
    EXPECT_EQ(html.find(absent), std::string::npos) << absent;
  EXPECT_EQ(numbers()["series"]["points"][0]["name"], "soft");
  EXPECT_FALSE(numbers().contains("table"));
  EXPECT_EQ(numbers()["costs"][0]["wall_seconds"], 10.0);
}

}  // namespace
}  // namespace grainlaw
