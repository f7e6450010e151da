// From nothing to a prediction: the error of predictions as DEM time is spent.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/compare_runs.h"
#include "apps/exit_code.h"
#include "apps/io/campaign_input.h"
#include "apps/io/campaign_scenes.h"
#include "apps/study_kinds.h"
#include "apps/study_timing.h"

namespace grainlaw::study {
namespace {

io::Campaign read(const io::WholeStudy& study) {
  io::Campaign campaign = io::read_campaign(study.campaign);
  if (!campaign.start_table.empty()) {
    throw io::InputError(study.campaign.string() +
                         ": has a start_table; from nothing means that no law is known");
  }
  if (!campaign.shear_boxes.empty() || campaign.seeds.size() > 1) {
    throw io::InputError(study.campaign.string() +
                         ": this study takes chutes with one seed, no shear boxes");
  }
  return campaign;
}

/// Calibration runs first.
std::vector<io::SceneFile> scenes_of(const io::Campaign& campaign) {
  std::vector<io::SceneFile> scenes;
  for (const io::PlannedRun& run : io::planned_runs(campaign)) scenes.push_back(run.file);
  return scenes;
}

/// The runs of a campaign, all steady.
struct Runs {
  std::vector<dem::LocalData> fitted;
  std::vector<dem::LocalData> predicted;
  double cpu_per_wall = 1.0;  ///< of the fitted ones
};

Runs gather(const std::vector<Run>& runs, std::size_t fitted, Result& result) {
  Runs sorted;
  double cpu = 0.0, wall = 0.0;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const Run& run = runs[k];
    const bool steady = run.data && run.data->window.steady;
    if (!steady) {
      result.remarks.push_back(fmt::format(
          "{} is left out: {}", run.name, run.data ? run.data->window.reason : run.failure));
      continue;
    }
    (k < fitted ? sorted.fitted : sorted.predicted).push_back(*run.data);
    if (k >= fitted) continue;
    cpu += run.cpu_seconds;
    wall += run.data->summary.wall_seconds;
  }
  if (wall > 0.0) sorted.cpu_per_wall = cpu / wall;
  return sorted;
}

Point point_at(const report::TimeErrorPoint& of, double share, double cpu_per_wall, Seconds fit) {
  Point point;
  point.setting = share < 1.0 ? fmt::format("1/{:.0f}", 1.0 / share) : "all";
  point.cpu_seconds = of.dem_wall_seconds * cpu_per_wall + fit.cpu;
  point.wall_seconds = of.dem_wall_seconds + fit.wall;
  point.cost = point.cpu_seconds;
  point.failure = of.failure;
  return point;
}

void add_points(Result& result,
                const std::vector<report::TimeErrorPoint>& times,
                const Runs& runs,
                Seconds fit) {
  std::vector<double> tilts;
  for (const dem::LocalData& run : runs.fitted) tilts.push_back(run.conditions.inclination);
  for (std::size_t k = 0; k < runs.predicted.size(); ++k) {
    const double tilt = runs.predicted[k].conditions.inclination;
    const auto kind = calibration::sample_kind(tilt, tilts);
    for (std::size_t t = 0; t < times.size(); ++t) {
      // The last of the points holds all of the averaging time, each before it half of the next.
      const double share = std::pow(0.5, static_cast<double>(times.size() - 1 - t));
      Point point = point_at(times[t], share, runs.cpu_per_wall, fit);
      point.quantity = fmt::format("velocity at {:.4g} degrees", io::degrees(tilt));
      point.series = fmt::format("{:.4g} deg, {}", io::degrees(tilt), name(kind));
      if (!point.failed()) {
        point.error = times[t].profile_error[k];
        point.error_bar = times[t].profile_standard_error[k];
        if (!std::isfinite(point.error)) point.failure = "no steady flow predicted";
      }
      result.points.push_back(point);
    }
  }
}

/// Where more DEM time no longer helps, the law or the geometry is what is left.
std::string tail_text(const std::vector<Point>& points, const std::string& quantity) {
  std::vector<const Point*> known;
  for (const Point& point : points) {
    if (point.quantity == quantity && !point.failed()) known.push_back(&point);
  }
  if (known.size() < 3) return {};
  const Point& last = *known.back();
  const Point& earlier = *known[known.size() - 3];  // a quarter of the averaging time
  const bool flat = last.error > 0.7 * earlier.error;
  const bool noise = last.error <= 2.0 * last.error_bar;
  if (!flat || noise) return {};
  return fmt::format(
      "{}: from {} to {} of the averaging time the error went from {} to {}, where statistics "
      "alone "
      "would halve it: what is left is bias of the law or of the base, not noise.",
      quantity,
      earlier.setting,
      last.setting,
      error_text(earlier.error),
      error_text(last.error));
}

}  // namespace

Plan plan(const io::WholeStudy& study) {
  return {.scenes = scenes_of(read(study)), .other = {"fits and predictions, some seconds"}};
}

Result run(const io::WholeStudy& study, const io::StudyFile& file, const Context& context) {
  const io::Campaign campaign = read(study);
  if (campaign.predict_tilts.empty()) {
    throw io::InputError(study.campaign.string() + ": no tilt to predict");
  }
  Result result;
  const std::vector<Run> all = run_scenes(scenes_of(campaign), context);
  const Runs runs = gather(all, campaign.calibrate_tilts.size(), result);
  if (runs.predicted.empty()) throw NoAnswer("no run to hold predictions against is steady");
  calibration::MuPhiFit fit;
  const Seconds fit_seconds = median_seconds(file.repeats, [&] {
    fit = calibration::fit_mu_phi(runs.fitted);
    continuum::steady_chute(fit.table, chute_case(runs.predicted.front().conditions));
  });
  add_points(result, error_against_time(runs.fitted, runs.predicted, fit.table), runs, fit_seconds);
  result.reference = "the DEM profiles of the tilts that were not fitted.";
  result.error_label = "velocity error, relative L_2";
  result.cost_label = "CPU time from nothing to a prediction [s]";
  for (const std::string& quantity : quantities(result.points)) {
    const std::string tail = tail_text(result.points, quantity);
    if (!tail.empty()) result.remarks.push_back(tail);
  }
  result.remarks.push_back(fmt::format(
      "Cost: packing, start-up and averaging of the fitted runs, and the fit ({:.2g} s); the runs "
      "that only check the predictions do not count. Error bars: the noise of the checking runs.",
      fit_seconds.cpu));
  result.advice = advise(result.points, file.accuracy);
  return result;
}

}  // namespace grainlaw::study
