#include "dem/steady_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "dem/statistics.h"

namespace grainlaw::dem {
namespace {

constexpr double confidence = 0.99;

struct Series {
  std::string_view name;
  std::vector<double> values;
};

std::vector<Series> series_of(std::span<const ProfileFrame> frames) {
  std::vector<Series> series{{"mean velocity", {}}, {"kinetic energy", {}}, {"centre of mass", {}}};
  for (const ProfileFrame& frame : frames) {
    series[0].values.push_back(mean_velocity(frame));
    series[1].values.push_back(frame.kinetic_energy);
    series[2].values.push_back(frame.centre_of_mass);
  }
  return series;
}

/// First frame of the last stretch of rest_time; frames.size() where the run is shorter.
std::size_t rest_begin(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria) {
  const double begin = frames.back().end - criteria.rest_time;
  if (frames.front().begin > begin) return frames.size();
  std::size_t k = frames.size() - 1;
  while (frames[k].begin > begin) --k;
  return k;
}

bool at_rest(std::span<const double> velocity, const SteadyCriteria& criteria) {
  const auto slow = [&](double v) { return std::abs(v) <= criteria.rest_velocity; };
  return !velocity.empty() && std::ranges::all_of(velocity, slow);
}

/// True where the second half of the run gained at least half as much speed as the first: a
/// relaxation towards a steady speed gains less and less.
bool keeps_gaining(std::span<const double> velocity) {
  const std::size_t n = velocity.size();
  if (n < 8) return false;
  const double first = velocity[n / 2] - velocity[0];
  const double second = velocity[n - 1] - velocity[n / 2];
  return first > 0.0 && second > 0.5 * first;
}

/// End of three relaxation times, for the velocity of the frames from `first` on [time].
double relaxed_time(std::span<const ProfileFrame> frames,
                    std::span<const double> velocity,
                    std::size_t first) {
  const auto later = velocity.subspan(first);
  const double mean =
      std::accumulate(later.begin(), later.end(), 0.0) / static_cast<double>(later.size());
  const auto risen = [&](double v) { return v >= (1.0 - 1.0 / std::numbers::e) * mean; };
  const auto reached = std::ranges::find_if(velocity, risen) - velocity.begin();
  return 3.0 * frames[static_cast<std::size_t>(reached)].begin;
}

/// The series that drifts most clearly, if any does.
std::string drift_in_words(std::span<const Series> series, std::size_t first) {
  std::string words;
  double clearest = 0.0;
  for (const Series& s : series) {
    const Drift drift = linear_drift(std::span(s.values).subspan(first));
    const double clarity = std::abs(drift.change) / drift.error;
    if (!drift.significant(confidence) || clarity <= clearest) continue;
    clearest = clarity;
    words = fmt::format(
        "{} changes by {:.3g} +- {:.2g} over the window", s.name, drift.change, drift.error);
  }
  return words;
}

}  // namespace

std::string_view name(FlowState state) {
  constexpr std::array<std::string_view, 5> names{
      "short", "drifting", "accelerating", "arrested", "steady"};
  return names[static_cast<std::size_t>(state)];
}

Assessment assess(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria) {
  if (frames.empty()) return {.reason = "short: no frame yet"};
  const auto series = series_of(frames);
  const std::vector<double>& velocity = series[0].values;
  const std::size_t last_stretch = rest_begin(frames, criteria);
  if (at_rest(std::span(velocity).subspan(last_stretch), criteria)) {
    return {FlowState::arrested,
            true,
            last_stretch,
            fmt::format("arrested: slower than {} for {} time units",
                        criteria.rest_velocity,
                        criteria.rest_time)};
  }
  const bool gaining = criteria.mean_flow && keeps_gaining(velocity);
  if (gaining && velocity.back() > criteria.runaway_velocity) {
    return {FlowState::accelerating,
            true,
            frames.size() * 3 / 4,
            fmt::format("accelerating: mean velocity {:.3g}, beyond any dense flow of this depth "
                        "({:.3g}), and still rising",
                        velocity.back(),
                        criteria.runaway_velocity)};
  }
  std::size_t first = 0;
  const std::span<const Series> judged = std::span(series).subspan(criteria.mean_flow ? 0 : 1);
  for (const Series& s : judged) first = std::max(first, mser_truncation(s.values));
  const double relaxed =
      std::max(criteria.start_up, criteria.mean_flow ? relaxed_time(frames, velocity, first) : 0.0);
  const auto start = std::ranges::find_if(
      frames, [&](const ProfileFrame& frame) { return frame.begin >= relaxed; });
  constexpr std::ptrdiff_t fewest_frames = 8;  // to judge a drift by
  const bool is_relaxed = frames.end() - start >= fewest_frames;
  if (is_relaxed) first = std::max(first, static_cast<std::size_t>(start - frames.begin()));
  const std::string drift = drift_in_words(judged, first);
  if (!drift.empty()) {
    return {gaining ? FlowState::accelerating : FlowState::drifting,
            false,
            first,
            fmt::format("{}: {}", gaining ? "accelerating" : "drifting", drift)};
  }
  if (!is_relaxed) {
    return {FlowState::too_short,
            false,
            first,
            fmt::format("short: the start is over at about t = {:.4g}", relaxed)};
  }
  const double length = frames.back().end - frames[first].begin;
  // Frame lengths are sums of steps: allow for rounding.
  if (length < criteria.averaging_time * (1.0 - 1e-9)) {
    return {FlowState::too_short,
            false,
            first,
            fmt::format("short: no drift over {:.4g} time units, {:.4g} are wanted",
                        length,
                        criteria.averaging_time)};
  }
  return {FlowState::steady,
          true,
          first,
          fmt::format("steady: no drift at {} % confidence over {:.4g} time units",
                      100.0 * confidence,
                      length)};
}

SteadyWindow steady_window(const Assessment& assessment, std::span<const ProfileFrame> frames) {
  SteadyWindow window;
  window.steady = assessment.state == FlowState::steady;
  window.reason = assessment.reason;
  if (frames.empty()) return window;
  window.begin = frames[assessment.first_frame].begin;
  window.end = frames.back().end;
  return window;
}

}  // namespace grainlaw::dem
