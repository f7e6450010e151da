// What one run tells of averaging: over how much time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "apps/exit_code.h"
#include "apps/study_kinds.h"
#include "apps/study_source.h"
#include "dem/estimate_text.h"
#include "dem/fields.h"
#include "dem/statistics.h"

namespace grainlaw::study {
namespace {

using Frames = std::span<const dem::ProfileFrame>;

/// A number that a stretch of a run gives.
struct Quantity {
  std::string name;
  double (*of)(const std::vector<dem::FieldRow>& rows);
};

double mean_velocity(const std::vector<dem::FieldRow>& rows) {
  double momentum = 0.0, mass = 0.0;
  for (const dem::FieldRow& row : rows) {
    momentum += row.momentum[0];
    mass += row.density;
  }
  return momentum / mass;
}

double stress_ratio(const std::vector<dem::FieldRow>& rows) {
  double shear = 0.0, normal = 0.0;
  for (const dem::FieldRow& row : rows) {
    shear += row.shear_stress;
    normal += row.normal_stress;
  }
  return shear / normal;
}

/// Weighted with itself: the bulk counts, the surface hardly.
double volume_fraction(const std::vector<dem::FieldRow>& rows) {
  double squares = 0.0, sum = 0.0;
  for (const dem::FieldRow& row : rows) {
    squares += row.volume_fraction * row.volume_fraction;
    sum += row.volume_fraction;
  }
  return squares / sum;
}

/// A chute holds mu, a box sheared at a rate holds the velocity: the other one fluctuates.
std::vector<Quantity> quantities_of(const dem::LocalData& data) {
  const bool box = data.conditions.geometry == "simple_shear";
  const Quantity flow =
      box ? Quantity{"mu", stress_ratio} : Quantity{"mean velocity", mean_velocity};
  return {flow, {"phi", volume_fraction}};
}

double value_of(const dem::LocalData& data, Frames frames, const Quantity& quantity) {
  return quantity.of(dem::coarse_grain(
      dem::mean_moments(frames), data.frames, data.frames.kernel, data.conditions));
}

std::vector<double> series_of(const dem::LocalData& data, Frames frames, const Quantity& quantity) {
  std::vector<double> series;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    series.push_back(value_of(data, frames.subspan(k, 1), quantity));
  }
  return series;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double mean_square_off(const std::vector<double>& values, double centre) {
  double sum = 0.0;
  for (const double value : values) sum += (value - centre) * (value - centre);
  return sum / static_cast<double>(values.size());
}

/// What an independent measurement says, and its standard error.
struct Reference {
  double value = nan;
  double error = 0.0;
};

/// Errors of stretches of 1/parts of the averaging time.
struct Stretches {
  int parts = 1;
  int freedom = 0;  ///< degrees of, that the error rests on
  double time = 0.0;
  double error = nan;      ///< root mean square, relative
  double error_bar = nan;  ///< from the number of stretches
  double claimed = nan;    ///< standard error that the stretches state themselves, relative
};

/// Root mean square distance of the stretches from the reference. Without one they are held against
/// their own mean, which costs a degree of freedom; the whole run then has no error.
Stretches stretches(const dem::LocalData& data,
                    Frames frames,
                    const Quantity& quantity,
                    const std::optional<Reference>& reference,
                    int parts) {
  const std::size_t length = frames.size() / static_cast<std::size_t>(parts);
  Stretches result{.parts = parts};
  std::vector<double> values;
  double claimed = 0.0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(parts); ++k) {
    const Frames stretch = frames.subspan(k * length, length);
    values.push_back(value_of(data, stretch, quantity));
    const double error = dem::block_average(series_of(data, stretch, quantity)).error;
    claimed += error * error / parts;
  }
  const double scale = std::abs(reference ? reference->value : mean(values));
  result.time = frames[length - 1].end - frames.front().begin;
  result.claimed = std::sqrt(claimed) / scale;
  const int freedom = reference ? parts : parts - 1;
  result.freedom = freedom;
  if (freedom == 0) return result;
  const double square = mean_square_off(values, reference ? reference->value : mean(values)) *
                        static_cast<double>(parts) / freedom;
  result.error = std::sqrt(square) / scale;
  // A root mean square of n normal numbers is known to 1/sqrt(2 n) of itself.
  result.error_bar = std::hypot(result.error / std::sqrt(2.0 * freedom),
                                reference ? reference->error / scale : 0.0);
  return result;
}

/// A straight line through ln(error) over ln(time). The logarithm of a root mean square with n
/// degrees of freedom lies 1/(2 n) too low in the mean and has the variance 1/(2 n), both to first
/// order, which is too rough below 3 degrees.
struct Slope {
  double value = nan;
  double error = nan;
};

Slope slope_of(const std::vector<Stretches>& all) {
  double w = 0.0, wx = 0.0, wy = 0.0;
  std::vector<std::array<double, 3>> data;
  for (const Stretches& one : all) {
    if (one.freedom < 3 || !(one.error > 0.0)) continue;
    const double weight = 2.0 * one.freedom;
    data.push_back({std::log(one.time), std::log(one.error) + 1.0 / weight, weight});
    w += weight;
    wx += weight * data.back()[0];
    wy += weight * data.back()[1];
  }
  double xx = 0.0, xy = 0.0;
  for (const auto& [x, y, weight] : data) {
    xx += weight * (x - wx / w) * (x - wx / w);
    xy += weight * (x - wx / w) * (y - wy / w);
  }
  return data.size() < 2 ? Slope{} : Slope{xy / xx, 1.0 / std::sqrt(xx)};
}

std::string slope_text(const std::string& quantity, const Slope& slope) {
  return fmt::format(
      "{}: the error falls with the power {} of the time, by the stretches up to a "
      "quarter (-0.5 expected of independent samples).",
      quantity,
      value_with_error(slope.value, slope.error));
}

/// A flat tail: the whole run is farther off than its own standard error allows.
bool is_biased(const Stretches& whole) {
  return whole.error > 2.0 * whole.claimed;
}

std::string bias_text(const std::string& quantity, const Stretches& whole) {
  return fmt::format(
      "{}: the whole run is off by {} where its own standard error is {}. What stays is bias (this "
      "base, this sample of grains, drift), which no averaging of one run takes away: take several "
      "seeds, or a larger base.",
      quantity,
      error_text(whole.error),
      error_text(whole.claimed));
}

/// Error = C / sqrt(time) through the claimed error of the whole run, which rests on most data.
std::string time_for(const std::string& quantity,
                     const Stretches& whole,
                     double accuracy,
                     double cost) {
  const double factor = std::pow(whole.claimed / accuracy, 2);
  return fmt::format(
      "For {} in {} (one standard error, by its 1/sqrt(time)) average {:.2g} times as long as this "
      "run, whose cost was {:.3g} s.",
      error_text(accuracy),
      quantity,
      factor,
      cost);
}

std::vector<io::SceneFile> scenes_of(const io::AveragingTimeStudy& study) {
  std::vector<io::SceneFile> scenes = source_scenes(study.source);
  for (const double seed : study.reference_seeds) {
    const std::string number = fmt::format("{:.0f}", seed);
    scenes.push_back(changed(
        scenes.front(), {{"", "name", "\"reference_seed" + number + "\""}, {"", "seed", number}}));
  }
  return scenes;
}

Frames window_frames(const dem::LocalData& data) {
  return dem::frames_inside(data.frames, data.window);
}

std::optional<Reference> reference_of(const std::vector<Run>& runs, const Quantity& quantity) {
  if (runs.size() < 2) return std::nullopt;
  std::vector<double> values;
  double claimed = 0.0;
  for (auto run = runs.begin() + 1; run != runs.end(); ++run) {
    const Frames frames = window_frames(*run->data);
    values.push_back(value_of(*run->data, frames, quantity));
    claimed += std::pow(dem::block_average(series_of(*run->data, frames, quantity)).error, 2);
  }
  const auto n = static_cast<double>(values.size());
  const double scatter = mean_square_off(values, mean(values)) / std::max(1.0, n - 1.0);
  return Reference{mean(values), std::sqrt(std::max(scatter, claimed / (n * n)))};
}

/// Seconds of a run that stops after 1/parts of its averaging time.
double share_of_cost(double seconds, const dem::RunSummary& run, int parts) {
  const double start = run.startup_wall_seconds / run.wall_seconds;
  return seconds * (start + (1.0 - start) / parts);
}

void add_points(Result& result, const Run& run, const Quantity& quantity, const Stretches& one) {
  Point point;
  point.quantity = point.series = quantity.name;
  point.setting = one.parts == 1 ? "all" : fmt::format("1/{}", one.parts);
  point.cpu_seconds = share_of_cost(run.cpu_seconds, run.data->summary, one.parts);
  point.wall_seconds = share_of_cost(run.data->summary.wall_seconds, run.data->summary, one.parts);
  point.cost = std::isfinite(point.cpu_seconds) ? point.cpu_seconds : point.wall_seconds;
  point.error = one.error;
  point.error_bar = one.error_bar;
  if (std::isfinite(one.error)) result.points.push_back(point);
  point.series += ", claimed";
  point.error = one.claimed;
  point.error_bar = nan;
  if (std::isfinite(one.claimed)) result.points.push_back(point);
}

void study_quantity(Result& result,
                    const std::vector<Run>& runs,
                    const Quantity& quantity,
                    double accuracy) {
  const dem::LocalData& data = *runs.front().data;
  const Frames frames = window_frames(data);
  const std::optional<Reference> reference = reference_of(runs, quantity);
  std::vector<Stretches> all;
  for (const int parts : {16, 8, 4, 2, 1}) {
    if (frames.size() < static_cast<std::size_t>(parts)) continue;
    all.push_back(stretches(data, frames, quantity, reference, parts));
    add_points(result, runs.front(), quantity, all.back());
  }
  result.remarks.push_back(slope_text(quantity.name, slope_of(all)));
  const double cost = std::isfinite(runs.front().cpu_seconds) ? runs.front().cpu_seconds
                                                              : data.summary.wall_seconds;
  const Stretches& whole = all.back();
  result.advice.push_back(is_biased(whole) && whole.error > accuracy
                              ? bias_text(quantity.name, whole)
                              : time_for(quantity.name, whole, accuracy, cost));
}

}  // namespace

Plan plan(const io::AveragingTimeStudy& study) {
  Plan plan{.scenes = scenes_of(study), .other = {}};
  if (plan.scenes.empty()) plan.other.push_back("cuts " + study.source.run.string());
  return plan;
}

Result run(const io::AveragingTimeStudy& study, const io::StudyFile& file, const Context& context) {
  const std::vector<Run> runs = obtain(study.source, scenes_of(study), context);
  if (window_frames(*runs.front().data).size() < 8) {
    throw NoAnswer(runs.front().name +
                   ": fewer than 8 frames to cut; give it a longer averaging_time, or shorter "
                   "frames");
  }
  Result result;
  result.reference = runs.size() > 1
                         ? fmt::format("the mean of {} runs on other bases.", runs.size() - 1)
                         : "the scatter of the stretches about each other, which a bias common to "
                           "all of them does not show in (reference_seeds would).";
  if (!std::isfinite(runs.front().cpu_seconds)) result.cost_label = "wall time [s]";
  for (const Quantity& quantity : quantities_of(*runs.front().data)) {
    study_quantity(result, runs, quantity, file.accuracy);
  }
  result.remarks.emplace_back(
      "Each point: root mean square over all stretches of that length; \"claimed\" is the standard "
      "error that stretches state of themselves (absent below 4 frames).");
  return result;
}

}  // namespace grainlaw::study
