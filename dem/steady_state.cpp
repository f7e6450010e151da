#include "dem/steady_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "dem/estimate_text.h"
#include "dem/statistics.h"

namespace grainlaw::dem {
namespace {

constexpr double confidence = 0.99;
constexpr double balance = 0.05;  // of the drive: no steady flow of data/local exceeds 0.003

enum class Quantity { velocity, energy, height };

struct Series {
  std::string_view name;
  Quantity quantity;
  std::vector<double> values;
};

/// Mean velocities of the lowest, middle and highest third of the mass; a bin that two of them
/// share counts for both by its share of mass.
std::array<double, 3> velocity_of_thirds(const ProfileFrame& frame) {
  double whole = 0.0;
  for (const BinMoments& bin : frame.bins) whole += bin.mass;
  const double third = whole / 3.0;
  std::array<double, 3> momentum{};
  double below = 0.0;
  for (const BinMoments& bin : frame.bins) {
    for (std::size_t j = 0; bin.mass > 0.0 && j < 3; ++j) {
      const double begin = std::max(below, static_cast<double>(j) * third);
      const double end = std::min(below + bin.mass, static_cast<double>(j + 1) * third);
      momentum[j] += std::max(0.0, end - begin) * bin.momentum[0] / bin.mass;
    }
    below += bin.mass;
  }
  for (double& velocity : momentum) velocity = third > 0.0 ? velocity / third : 0.0;
  return momentum;
}

/// The series to judge, the mean velocity first. Thirds of a profile of one or two bins would
/// repeat the mean.
std::vector<Series> series_of(std::span<const ProfileFrame> frames) {
  std::vector<Series> series{{"mean velocity", Quantity::velocity, {}},
                             {"kinetic energy", Quantity::energy, {}},
                             {"centre of mass", Quantity::height, {}},
                             {"velocity of the lowest third", Quantity::velocity, {}},
                             {"velocity of the middle third", Quantity::velocity, {}},
                             {"velocity of the highest third", Quantity::velocity, {}}};
  for (const ProfileFrame& frame : frames) {
    const auto [lowest, middle, highest] = velocity_of_thirds(frame);
    const std::array values{
        mean_velocity(frame), frame.kinetic_energy, frame.centre_of_mass, lowest, middle, highest};
    for (std::size_t k = 0; k < values.size(); ++k) series[k].values.push_back(values[k]);
  }
  if (frames.front().bins.size() < 3) series.resize(3);
  return series;
}

std::vector<double> fastest_third(std::span<const ProfileFrame> frames) {
  std::vector<double> speeds;
  for (const ProfileFrame& frame : frames) {
    const auto thirds = velocity_of_thirds(frame);
    speeds.push_back(std::abs(
        *std::ranges::max_element(thirds, {}, [](double velocity) { return std::abs(velocity); })));
  }
  return speeds;
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

/// The begin of the rest that the run ends in [time].
double arrest_time(std::span<const ProfileFrame> frames,
                   std::span<const double> velocity,
                   const SteadyCriteria& criteria) {
  std::size_t k = frames.size() - 1;
  while (k > 0 && std::abs(velocity[k - 1]) <= criteria.rest_velocity) --k;
  return frames[k].begin;
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

/// How a velocity comes from its first value to its later mean.
struct Approach {
  double way = 0.0;   ///< between the two [length/time]
  double time = 0.0;  ///< in which all but 1/e of it is gone [time]
};

/// Judged by the frames before `first`. They are counted: the first frame that is close enough is
/// so by its noise, and early.
Approach approach(std::span<const ProfileFrame> frames,
                  std::span<const double> velocity,
                  std::size_t first) {
  const auto later = velocity.subspan(first);
  const double mean =
      std::accumulate(later.begin(), later.end(), 0.0) / static_cast<double>(later.size());
  const double way = mean - velocity[0];
  const auto far = [&](double v) { return (mean - v) * way > way * way / std::numbers::e; };
  const auto count = std::ranges::count_if(velocity.first(first), far);
  return {std::abs(way), frames[static_cast<std::size_t>(count)].begin - frames.front().begin};
}

std::size_t first_frame_after(std::span<const ProfileFrame> frames, double time) {
  const auto after = [&](const ProfileFrame& frame) { return frame.begin >= time; };
  return static_cast<std::size_t>(std::ranges::find_if(frames, after) - frames.begin());
}

/// Three relaxation times, or as many more as it takes until what is left of an exponential
/// approach moves the mean over averaging_time by less than half its standard error.
double relaxed_time(std::span<const ProfileFrame> frames,
                    std::span<const double> velocity,
                    std::size_t first,
                    double averaging_time) {
  const auto [way, time] = approach(frames, velocity, first);
  const double relaxed = frames.front().begin + 3.0 * time;
  // The last of the run: an approach that is still on would count as scatter.
  const double begin = std::max(relaxed, frames.back().end - averaging_time);
  const BlockAverage window = block_average(velocity.subspan(first_frame_after(frames, begin)));
  if (!(window.error > 0.0)) return relaxed;
  const double left = way * std::exp(-3.0) * std::min(1.0, time / averaging_time);
  return relaxed + time * std::max(0.0, std::log(2.0 * left / window.error));
}

/// When the start is over, by the criteria and by the slowest of the velocities [time].
double start_end(std::span<const ProfileFrame> frames,
                 std::span<const Series> series,
                 std::size_t first,
                 const SteadyCriteria& criteria) {
  double end = criteria.start_up;
  if (!criteria.mean_flow) return end;
  for (const Series& s : series) {
    if (s.quantity != Quantity::velocity) continue;
    end = std::max(end, relaxed_time(frames, s.values, first, criteria.averaging_time));
  }
  return end;
}

/// Series that drift, as the reason names them.
struct Drifts {
  std::string clearest;   ///< that is no slow compaction
  std::string tolerated;  ///< slow compaction
};

Drifts drifts_in_words(std::span<const Series> series,
                       std::size_t first,
                       const SteadyCriteria& criteria) {
  Drifts words;
  double clearest = 0.0;
  for (const Series& s : series) {
    const Drift drift = linear_drift(std::span(s.values).subspan(first));
    const double clarity = std::abs(drift.change) / drift.error;
    if (!drift.significant(confidence)) continue;
    std::string word = fmt::format(
        "{} changes by {} over the window", s.name, value_with_error(drift.change, drift.error));
    if (s.quantity == Quantity::height &&
        std::abs(drift.change) < criteria.compaction * s.values.back()) {
      words.tolerated = std::move(word);
    } else if (clarity > clearest) {
      clearest = clarity;
      words.clearest = std::move(word);
    }
  }
  return words;
}

/// The largest part of the drive that may be left to accelerate the flow, on average over `length`.
double unbalanced_part(std::span<const double> velocity,
                       double length,
                       const SteadyCriteria& criteria) {
  if (!(criteria.drive > 0.0)) return 0.0;
  return linear_drift(velocity).most(confidence) / (length * criteria.drive);
}

/// Of a flow that neither rests nor runs away: the window after the start, its drift and length.
Assessment judge_drift(std::span<const ProfileFrame> frames,
                       std::span<const Series> series,
                       bool gaining,
                       const SteadyCriteria& criteria) {
  std::size_t first = 0;
  const std::span<const Series> judged = series.subspan(criteria.mean_flow ? 0 : 1);
  for (const Series& s : judged) {
    // Of a ramp, as slow compaction is, the rule cuts as much as it may.
    if (s.quantity == Quantity::height && criteria.compaction > 0.0) continue;
    first = std::max(first, mser_truncation(s.values));
  }
  const double relaxed = start_end(frames, series, first, criteria);
  const std::size_t start = first_frame_after(frames, relaxed);
  constexpr std::size_t fewest_frames = 8;  // to judge a drift by
  const bool is_relaxed = start + fewest_frames <= frames.size();
  if (is_relaxed) first = std::max(first, start);
  const Drifts drifts = drifts_in_words(judged, first, criteria);
  if (!drifts.clearest.empty()) {
    const FlowState state = gaining ? FlowState::accelerating : FlowState::drifting;
    return {state, false, first, fmt::format("{}: {}", name(state), drifts.clearest)};
  }
  const auto too_short = [&](std::string reason) {
    return Assessment{FlowState::too_short, false, first, std::move(reason)};
  };
  if (!is_relaxed) {
    return too_short(fmt::format("short: the start is over at about t = {:.4g}", relaxed));
  }
  const double length = frames.back().end - frames[first].begin;
  // Frame lengths are sums of steps: allow for rounding.
  if (length < criteria.averaging_time * (1.0 - 1e-9)) {
    return too_short(fmt::format("short: no drift over {:.4g} time units, {:.4g} are wanted",
                                 length,
                                 criteria.averaging_time));
  }
  const double unbalanced =
      unbalanced_part(std::span(series[0].values).subspan(first), length, criteria);
  if (!(unbalanced <= balance)) {
    return too_short(
        fmt::format("short: friction balances the drive within {:.2g} % over {:.4g} "
                    "time units, {:.2g} % are wanted",
                    100.0 * unbalanced,
                    length,
                    100.0 * balance));
  }
  return {FlowState::steady,
          true,
          first,
          fmt::format("steady: no drift at {} % confidence over {:.4g} time units{}{}",
                      100.0 * confidence,
                      length,
                      drifts.tolerated.empty() ? "" : ", slow compaction apart: ",
                      drifts.tolerated)};
}

/// Of frames under one and the same drive.
Assessment judge(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria) {
  const auto series = series_of(frames);
  // A box that flows both ways has no mean flow: its fastest third tells.
  const std::vector<double> velocity =
      criteria.mean_flow ? series[0].values : fastest_third(frames);
  const std::size_t last_stretch = rest_begin(frames, criteria);
  if (at_rest(std::span(velocity).subspan(last_stretch), criteria)) {
    const double since = arrest_time(frames, velocity, criteria);
    return {FlowState::arrested,
            true,
            last_stretch,
            fmt::format("arrested at t = {:.4g}: slower than {} for {} time units",
                        since,
                        criteria.rest_velocity,
                        criteria.rest_time),
            since};
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
  return judge_drift(frames, series, gaining, criteria);
}

}  // namespace

std::string_view name(FlowState state) {
  constexpr std::array<std::string_view, 5> names{
      "short", "drifting", "accelerating", "arrested", "steady"};
  return names[static_cast<std::size_t>(state)];
}

Assessment assess(std::span<const ProfileFrame> frames, const SteadyCriteria& criteria) {
  if (frames.empty()) return {.reason = "short: no frame yet"};
  const std::size_t passed = first_frame_after(frames, criteria.last_change);
  if (passed == frames.size()) {
    return {.first_frame = passed - 1,
            .reason = fmt::format("short: the drive changes at t = {:.4g}, and no frame follows",
                                  criteria.last_change)};
  }
  Assessment assessment = judge(frames.subspan(passed), criteria);
  assessment.first_frame += passed;
  return assessment;
}

SteadyWindow steady_window(const Assessment& assessment, std::span<const ProfileFrame> frames) {
  SteadyWindow window;
  window.steady = assessment.state == FlowState::steady;
  window.reason = assessment.reason;
  window.arrested_at = assessment.arrested_at;
  if (frames.empty()) return window;
  window.begin = frames[assessment.first_frame].begin;
  window.end = frames.back().end;
  return window;
}

}  // namespace grainlaw::dem
