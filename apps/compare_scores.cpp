#include "apps/compare_scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/estimate_text.h"

namespace grainlaw {
namespace {

using calibration::LawResidual;
using calibration::StateComparison;
using report::Score;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string flags_text(const std::vector<continuum::RangeFlag>& flags) {
  std::string result;
  for (const continuum::RangeFlag& flag : flags) {
    result += (result.empty() ? "outside the data: " : ", ") + flag.quantity;
  }
  return result;
}

std::string flags_text(const std::vector<StateComparison>& states) {
  std::vector<continuum::RangeFlag> all;
  for (const StateComparison& state : states) {
    for (const continuum::RangeFlag& flag : state.out_of_domain) {
      const auto same = [&](const auto& other) { return other.quantity == flag.quantity; };
      if (std::ranges::none_of(all, same)) all.push_back(flag);
    }
  }
  return flags_text(all);
}

Score start(const report::FlowComparison& flow, const report::FlowPrediction& prediction) {
  Score score{.run = flow.data.name,
              .flow = flow.data.conditions.geometry,
              .quantity = {},
              .kind = prediction.kind,
              .difference = {},
              .budget = {},
              .remark = {}};
  return score;
}

Score start(const report::RunComparison& run, const std::string& quantity) {
  return {.run = run.data.name,
          .flow = run.data.conditions.geometry,
          .quantity = quantity,
          .kind = run.kind,
          .difference = {},
          .in_standard_errors = nan,
          .budget = {},
          .remark = {}};
}

/// "tilt step", with its number where there are several.
std::string change_of(const report::RunComparison& run, const calibration::Stretch& stretch) {
  int all = 0, number = 0;
  for (const calibration::Stretch& other : run.in_time) {
    if (other.change != stretch.change) continue;
    ++all;
    if (other.begin <= stretch.begin) ++number;
  }
  const std::string name{calibration::name(stretch.change)};
  return all > 1 ? fmt::format("{} {}", name, number) : name;
}

/// Both sides are known to a frame.
void compare_times(Score& score, const dem::Estimate& measured, const dem::Estimate& predicted) {
  const double ratio = predicted.value / measured.value;
  const double error =
      std::hypot(predicted.error, ratio * measured.error) / std::abs(measured.value);
  score.difference = {ratio - 1.0, error};
  score.in_standard_errors = std::abs(ratio - 1.0) / error;
  score.remark = fmt::format("DEM {}, continuum {:.4g} sqrt(d/g)",
                             value_with_error(measured.value, measured.error),
                             predicted.value);
}

Score stop_score(const report::RunComparison& run, const calibration::StoppingTime& stop) {
  Score score = start(run, "stopping time");
  if (stop.measured && stop.predicted) {
    compare_times(score, *stop.measured, {*stop.predicted, 0.0});
  } else {
    score.difference = {nan, nan};
    score.remark = stop.measured ? "DEM arrested, the continuum flows on"
                                 : "the continuum is ARRESTED, DEM flows on";
  }
  return score;
}

/// Root mean square over states, with that of their standard errors beside it.
double rms_error(const std::vector<StateComparison>& states,
                 LawResidual StateComparison::*quantity) {
  double sum = 0.0;
  for (const StateComparison& state : states) sum += std::pow((state.*quantity).statistics, 2);
  return std::sqrt(sum / static_cast<double>(states.size()));
}

double median_condition(const std::vector<StateComparison>& states) {
  std::vector<double> numbers;
  for (const StateComparison& state : states) numbers.push_back(state.condition_number);
  std::ranges::sort(numbers);
  return numbers[numbers.size() / 2];
}

double rms_in_errors(const std::vector<StateComparison>& states,
                     LawResidual StateComparison::*quantity) {
  double sum = 0.0;
  for (const StateComparison& state : states)
    sum += std::pow((state.*quantity).in_standard_errors, 2);
  return std::sqrt(sum / static_cast<double>(states.size()));
}

/// Those inside the data of the table; all of them where none is.
std::vector<StateComparison> judged(const std::vector<StateComparison>& states) {
  std::vector<StateComparison> inside;
  for (const StateComparison& state : states) {
    if (state.out_of_domain.empty()) inside.push_back(state);
  }
  return inside.empty() ? states : inside;
}

Score state_score(const report::FlowComparison& flow,
                  const report::FlowPrediction& prediction,
                  const char* name,
                  LawResidual StateComparison::*quantity) {
  Score score = start(flow, prediction);
  score.quantity = name;
  const std::vector<StateComparison> states = judged(prediction.states);
  if (states.empty()) {
    score.in_standard_errors = nan;
    score.remark = flow.data.window.steady ? "no state of flow" : "DEM not steady";
    return score;
  }
  const LawResidual& first = states.front().*quantity;
  const bool one = prediction.states.size() == 1;
  score.difference = one ? dem::Estimate{first.difference, first.statistics}
                         : dem::Estimate{calibration::rms_difference(states, quantity),
                                         rms_error(states, quantity)};
  score.in_standard_errors = one ? first.in_standard_errors : rms_in_errors(states, quantity);
  score.condition_number = median_condition(states);
  score.remark = flags_text(states);
  if (one) return score;
  score.remark = fmt::format(
      "rms of {} states{}{}", states.size(), score.remark.empty() ? "" : ", ", score.remark);
  const std::size_t outside = prediction.states.size() - states.size();
  if (outside > 0) score.remark += fmt::format("; {} more outside the data", outside);
  return score;
}

/// Answer, norm of the velocity and its parts; of a band or of a ring cell.
template <class Flow, class Norm>
Score velocity_score(const report::FlowComparison& flow,
                     const report::FlowPrediction& prediction,
                     const Flow& predicted,
                     const Norm* norm,
                     const char* name) {
  Score score = start(flow, prediction);
  score.quantity = name;
  score.condition_number = predicted.answer.condition_number;
  if (score.condition_number == 0.0 && !prediction.states.empty())
    score.condition_number = median_condition(judged(prediction.states));
  score.remark = std::string(continuum::name(predicted.answer.outcome));
  if (predicted.local_band_collapse) score.remark += ", LOCAL_BAND_COLLAPSE";
  const std::string flags = flags_text(predicted.answer.out_of_domain);
  if (!flags.empty()) score.remark += "; " + flags;
  score.in_standard_errors = nan;
  if (!flow.data.window.steady) score.remark += "; DEM not steady";
  if (norm == nullptr) return score;
  score.difference = norm->velocity;
  score.in_standard_errors = norm->in_standard_errors;
  return score;
}

Score band_score(const report::FlowComparison& flow,
                 const report::FlowPrediction& prediction,
                 const report::BandPrediction& band,
                 const char* name) {
  const auto* found = band.comparison ? &*band.comparison : nullptr;
  Score score =
      velocity_score(flow, prediction, band.band, found ? &found->profile : nullptr, name);
  if (found) score.budget = found->budget;
  return score;
}

Score ring_score(const report::FlowComparison& flow,
                 const report::FlowPrediction& prediction,
                 const report::RingPrediction& ring,
                 const char* name) {
  const auto* found = ring.comparison ? &*ring.comparison : nullptr;
  Score score = velocity_score(flow, prediction, ring.flow, found, name);
  if (found) score.budget = found->budget;
  return score;
}

}  // namespace

Score score_of(const report::RunComparison& run) {
  Score score = start(run, "u");
  score.condition_number = run.steady.answer.condition_number;
  score.remark = std::string(continuum::name(run.steady.answer.outcome));
  const std::string flags = flags_text(run.steady.answer.out_of_domain);
  if (!flags.empty()) score.remark += "; " + flags;
  if (!run.data.window.steady)
    score.remark += run.data.window.arrested_at ? "; DEM arrested" : "; DEM not steady";
  if (!run.error) return score;
  score.difference = run.error->velocity;
  score.in_standard_errors = run.error->in_standard_errors;
  score.budget = run.budget;
  return score;
}

std::vector<Score> in_time_scores(const report::RunComparison& run) {
  std::vector<Score> scores;
  for (const calibration::Stretch& stretch : run.in_time) {
    if (!std::isfinite(stretch.error)) continue;
    const std::string what = change_of(run, stretch);
    scores.push_back(start(run, "u, " + what));
    scores.back().difference = {stretch.error, nan};
    if (const auto& times = stretch.to_steady) {
      scores.push_back(start(run, "time to steady, " + what));
      compare_times(scores.back(), times->measured, times->predicted);
      scores.back().in_standard_errors = nan;  // fluctuations are not in the errors of the times
      scores.back().difference.error = nan;
    }
    if (stretch.stop) scores.push_back(stop_score(run, *stretch.stop));
  }
  return scores;
}

std::vector<Score> scores_of(const report::FlowComparison& flow, std::size_t table) {
  const report::FlowPrediction& prediction = flow.tables.at(table);
  std::vector<Score> scores;
  if (!prediction.states.empty() || !prediction.local) {
    scores.push_back(state_score(flow, prediction, "mu", &StateComparison::friction));
    scores.push_back(state_score(flow, prediction, "phi", &StateComparison::volume_fraction));
  }
  if (prediction.local) scores.push_back(band_score(flow, prediction, *prediction.local, "u"));
  if (prediction.nonlocal)
    scores.push_back(band_score(flow, prediction, *prediction.nonlocal, "u, nonlocal"));
  if (prediction.ring_local)
    scores.push_back(ring_score(flow, prediction, *prediction.ring_local, "u"));
  if (prediction.ring_nonlocal)
    scores.push_back(ring_score(flow, prediction, *prediction.ring_nonlocal, "u, nonlocal"));
  return scores;
}

}  // namespace grainlaw
