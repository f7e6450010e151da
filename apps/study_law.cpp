// Laws from simple to complex, fitted to the same runs: error of what they predict against the time
// of the fit, and their rank by AICc.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "apps/compare_cases.h"
#include "apps/compare_runs.h"
#include "apps/exit_code.h"
#include "apps/study_kinds.h"
#include "apps/study_laws.h"
#include "apps/study_timing.h"
#include "calibration/band_comparison.h"
#include "calibration/fit_summary.h"
#include "calibration/model_choice.h"

namespace grainlaw::study {
namespace {

continuum::SteadyChute predict(const FittedLaw& law, const dem::LocalData& run) {
  return continuum::steady_chute(law.table_for(run.conditions), chute_case(run.conditions));
}

/// How well a law gives back the velocities it was fitted to.
struct Score {
  double chi_squared = 0.0;
  int data = 0;
};

/// Rows are correlated over the width of the kernel, so every second one counts, or every one of
/// data without a kernel; the surface, where grains are few, does not.
Score score(const FittedLaw& law, const std::vector<dem::LocalData>& chutes) {
  constexpr double dense = 0.5;
  Score score;
  for (const dem::LocalData& run : chutes) {
    const auto steady = predict(law, run);
    const std::size_t stride = run.fields.empty() ? 1 : 2;
    for (std::size_t k = 0; k < run.rows.size(); k += stride) {
      const dem::LocalRow& row = run.rows[k];
      if (row.z < 0.0 || row.volume_fraction.value < dense || !(row.velocity.error > 0.0)) continue;
      const double there =
          steady.profile.rows.empty() ? 0.0 : calibration::velocity_at(steady.profile, row.z);
      score.chi_squared += std::pow((there - row.velocity.value) / row.velocity.error, 2);
      ++score.data;
    }
  }
  return score;
}

Point prediction(const Law& law, const dem::LocalData& run, const std::string& quantity) {
  Point point;
  point.quantity = point.series = quantity + " of " + run.name;
  point.setting = law.name;
  return point;
}

/// Error of the velocity profile, or why there is none.
struct Judged {
  dem::Estimate error;
  std::string failure;
};

Judged judge_chute(const FittedLaw& law, const dem::LocalData& run) {
  if (law.nonlocal) return {{}, "chutes are predicted by local laws"};
  const auto steady = predict(law, run);
  if (steady.profile.rows.empty()) return {{}, steady.answer.text};
  return {calibration::profile_error(run, steady.profile).velocity, {}};
}

Judged judge_band(const FittedLaw& law, const io::RunRecord& run) {
  if (law.of_chutes_only) return {{}, "it belongs to the tilt of a chute"};
  continuum::ShearBandCase band = band_case(scene_of(run), run.data);
  if (law.nonlocal) band.nonlocal_amplitude = *law.nonlocal;
  const auto found = continuum::shear_band(law.table_for(run.data.conditions), band);
  if (found.profile.rows.empty()) return {{}, found.answer.text};
  return {calibration::compare_band(run.data, band, found).profile.velocity, {}};
}

void add_predictions(
    Result& result, const Law& law, const FittedLaw& fitted, const LawData& data, Seconds seconds) {
  for (const io::RunRecord& run : data.predicted) {
    Point point = prediction(law, run.data, "velocity");
    point.cost = point.cpu_seconds = seconds.cpu;
    point.wall_seconds = seconds.wall;
    const Judged judged =
        is_chute(run.data) ? judge_chute(fitted, run.data) : judge_band(fitted, run);
    point.failure = judged.failure;
    if (!point.failed()) {
      point.error = judged.error.value;
      point.error_bar = judged.error.error;
    }
    result.points.push_back(point);
  }
}

/// Of one predicted run, the best law first.
std::string error_ranking(const std::vector<Point>& points, const std::string& quantity) {
  std::vector<Point> ranked;
  std::ranges::copy_if(points, std::back_inserter(ranked), [&](const Point& point) {
    return point.quantity == quantity && std::isfinite(point.error);
  });
  std::ranges::stable_sort(ranked, {}, &Point::error);
  std::string text;
  for (const Point& point : ranked)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", point.setting, error_text(point));
  return text.empty() ? text : fmt::format("By error in {}: {}.", quantity, text);
}

std::string rank_text(const calibration::ModelScore& one, double least) {
  return fmt::format(
      "{} ({}, {} coefficients)",
      one.name,
      std::isfinite(one.aicc) ? fmt::format("{:+.1f}", one.aicc - least) : "too few data to tell",
      one.coefficients);
}

std::string ranking(std::vector<calibration::ModelScore> scores) {
  std::ranges::stable_sort(scores, {}, &calibration::ModelScore::aicc);
  std::string text;
  for (const calibration::ModelScore& one : scores) {
    text += (text.empty() ? "" : ", ") + rank_text(one, scores.front().aicc);
  }
  return fmt::format(
      "By AICc on the velocities of the fitted chutes, above the best: {}. AICc is the lesser "
      "judge: it asks how well a law gives back what it was fitted to, takes the law as true and "
      "the errors as independent (every second row counts where a kernel smooths), and tells "
      "nothing within 2. A law that belongs to one tilt wins there and fails at the next.",
      text);
}

void add_remarks(Result& result, const LawData& data, std::vector<calibration::ModelScore> scores) {
  for (const std::string& quantity : quantities(result.points)) {
    const std::string text = error_ranking(result.points, quantity);
    if (!text.empty()) result.remarks.push_back(text);
  }
  if (!scores.empty()) result.remarks.push_back(ranking(std::move(scores)));
  if (!data.chutes.empty()) {
    result.remarks.emplace_back(
        "Laws of Bagnold belong to a tilt: the nearest fitted one is used.");
  }
  if (!data.bands.empty()) {
    result.remarks.push_back(
        fmt::format("The nonlocal amplitude is fitted to {} and tested on the other bands; chutes "
                    "are predicted by local laws.",
                    data.bands.front().data.name));
  }
  result.remarks.emplace_back("Error bars are the noise of the predicted runs.");
}

}  // namespace

Plan plan(const io::LawStudy& study) {
  const LawData data = read_law_data(study);
  return {.scenes = {},
          .other = {fmt::format("{} laws, fitted to {} chutes, {} boxes of simple shear and {} "
                                "shear bands, predicting {} "
                                "runs",
                                laws().size(),
                                data.chutes.size(),
                                data.boxes.size(),
                                data.bands.size(),
                                data.predicted.size())}};
}

Result run(const io::LawStudy& study, const io::StudyFile& file, const Context&) {
  const LawData data = read_law_data(study);
  Result result;
  std::vector<calibration::ModelScore> scores;
  for (const Law& law : laws()) {
    try {
      FittedLaw fitted;
      const Seconds seconds = median_seconds(file.repeats, [&] { fitted = law.fit(data); });
      add_predictions(result, law, fitted, data, seconds);
      if (fitted.nonlocal || data.chutes.empty()) continue;  // no velocities of chutes to score on
      const Score in_sample = score(fitted, data.chutes);
      scores.push_back({.name = law.name,
                        .coefficients = fitted.coefficients,
                        .chi_squared = in_sample.chi_squared,
                        .aicc = calibration::corrected_akaike(
                            in_sample.chi_squared, in_sample.data, fitted.coefficients)});
    } catch (const calibration::FitError& error) {
      for (const io::RunRecord& run : data.predicted) {
        result.points.push_back(prediction(law, run.data, "velocity"));
        result.points.back().failure = error.what();
      }
    }
  }
  if (std::ranges::all_of(result.points, &Point::failed)) {
    throw NoAnswer("no law could be fitted to these runs");
  }
  result.reference = "the DEM profiles of the predicted runs, which no law was fitted to.";
  result.cost_label = "CPU time of the fit [s]";
  result.error_label = "velocity error, relative L_2";
  result.ordered = false;
  add_remarks(result, data, std::move(scores));
  result.advice = advise(result.points, file.accuracy);
  return result;
}

}  // namespace grainlaw::study
