#include "calibration/transient_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "calibration/comparison.h"

namespace grainlaw::calibration {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double steady_share = 0.05;  ///< of the change of the mean velocity
constexpr double largest_share = 0.5;  ///< above, the change does not stand out of the fluctuations

using Frames = std::span<const dem::ProfileFrame>;

/// Velocity averaged over all flowing mass; the mass below the no-slip height is at rest.
double mean_velocity(const continuum::Profile& profile, double mass_per_area) {
  double momentum = 0.0;
  for (std::size_t k = 0; k + 1 < profile.rows.size(); ++k) {
    const continuum::ProfileRow& low = profile.rows[k];
    const continuum::ProfileRow& high = profile.rows[k + 1];
    momentum += 0.5 * (low.velocity + high.velocity) * (low.mass_above - high.mass_above);
  }
  return momentum / mass_per_area;
}

const dem::ProfileFrame* frame_at(const dem::ProfileFrames& frames, double time) {
  for (const dem::ProfileFrame& frame : frames.frames) {
    if (frame.begin <= time && time < frame.end) return &frame;
  }
  return nullptr;
}

/// Frames that lie in an interval whole.
Frames frames_between(const dem::LocalData& data, double begin, double end) {
  return dem::frames_inside(data.frames, {.begin = begin, .end = end});
}

/// Those at the end of a stretch, where it is judged.
Frames last_frames(const dem::LocalData& data, const Stretch& stretch) {
  const bool last = stretch.end >= data.frames.frames.back().end;
  if (last && data.window.steady) return dem::frames_inside(data.frames, data.window);
  return frames_between(data, stretch.end - 0.25 * (stretch.end - stretch.begin), stretch.end);
}

/// Velocities of the compared rows in one frame; NaN where a row holds no grain.
std::vector<double> row_velocities(const dem::LocalData& data,
                                   const std::vector<dem::LocalRow>& rows,
                                   const dem::ProfileFrame& frame) {
  const std::vector<double> all = dem::velocities(frame, data.frames.bins_per_row);
  std::vector<double> result;
  for (const dem::LocalRow& row : rows) {
    const double bin = std::floor((row.z - data.frames.z_begin) / data.frames.row_width());
    const bool there = bin >= 0.0 && bin < static_cast<double>(all.size());
    result.push_back(there ? all[static_cast<std::size_t>(bin)] : nan);
  }
  return result;
}

/// L2 of what a function gives for each row; rows without a number do not count.
template <class Value>
double l2(std::size_t rows, Value value) {
  double sum = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    const double x = value(i);
    if (std::isfinite(x)) sum += x * x;
  }
  return std::sqrt(sum);
}

/// L2 of the velocities in which a stretch ends.
double end_norm(const dem::LocalData& data,
                const std::vector<dem::LocalRow>& rows,
                const Stretch& stretch) {
  if (stretch.end >= data.frames.frames.back().end)
    return l2(rows.size(), [&](std::size_t i) { return rows[i].velocity.value; });
  const Frames frames = last_frames(data, stretch);
  std::vector<double> mean(rows.size(), 0.0);
  for (const dem::ProfileFrame& frame : frames) {
    const std::vector<double> velocity = row_velocities(data, rows, frame);
    for (std::size_t i = 0; i < rows.size(); ++i)
      mean[i] += velocity[i] / static_cast<double>(frames.size());
  }
  return l2(rows.size(), [&](std::size_t i) { return mean[i]; });
}

Moment moment(const dem::LocalData& data,
              const std::vector<dem::LocalRow>& rows,
              const dem::ProfileFrame& frame,
              const continuum::Snapshot& snapshot,
              double norm) {
  const std::vector<double> velocity = row_velocities(data, rows, frame);
  const double difference = l2(rows.size(), [&](std::size_t i) {
    return velocity_at(snapshot.profile, rows[i].z) - velocity[i];
  });
  return {.time = snapshot.time,
          .measured_mean = dem::mean_velocity(frame),
          .predicted_mean = mean_velocity(snapshot.profile, data.conditions.mass_per_area),
          .velocity_error = norm > 0.0 ? difference / norm : nan};
}

void add_moments(Stretch& stretch,
                 const dem::LocalData& data,
                 const std::vector<dem::LocalRow>& rows,
                 const std::vector<continuum::Snapshot>& predicted) {
  for (const continuum::Snapshot& snapshot : predicted) {
    if (snapshot.time < stretch.begin || snapshot.time >= stretch.end) continue;
    const dem::ProfileFrame* frame = frame_at(data.frames, snapshot.time);
    if (frame == nullptr) continue;
    stretch.moments.push_back(moment(data, rows, *frame, snapshot, stretch.velocity_norm));
  }
}

/// A time within the frame that ends at `end`.
dem::Estimate within_frame(double end, double length) {
  return {end - 0.5 * length, length / (2.0 * std::numbers::sqrt3)};
}

double frame_length(const dem::LocalData& data) {
  const auto& frames = data.frames.frames;
  return (frames.back().end - frames.front().begin) / static_cast<double>(frames.size());
}

/// Absent where neither side stops in this stretch.
std::optional<StoppingTime> stopping_time(const Stretch& stretch,
                                          const dem::LocalData& data,
                                          const continuum::TransientChute& predicted) {
  StoppingTime stop;
  // the first frame at rest begins there, so the layer stopped in the one before
  const auto rest = data.window.arrested_at;
  if (rest && stretch.begin < *rest && *rest <= stretch.end)
    stop.measured = within_frame(*rest - stretch.begin, frame_length(data));
  for (const continuum::ChuteEvent& event : predicted.events) {
    const bool last = stretch.end >= data.frames.frames.back().end;  // CVODE runs until it stops
    const bool here = event.time > stretch.begin && (last || event.time <= stretch.end);
    if (here && event.kind == continuum::ChuteEvent::Kind::arrest)
      stop.predicted = event.time - stretch.begin;
  }
  if (!stop.measured && !stop.predicted) return std::nullopt;
  return stop;
}

double last_stop(const Stretch& stretch) {
  if (!stretch.stop || !stretch.stop->measured || !stretch.stop->predicted) return stretch.end;
  return stretch.begin + std::max(stretch.stop->measured->value, *stretch.stop->predicted);
}

double root_mean_square_error(const Stretch& stretch) {
  double sum = 0.0;
  int count = 0;
  for (const Moment& moment : stretch.moments) {
    if (moment.time > last_stop(stretch) || !std::isfinite(moment.velocity_error)) continue;
    sum += moment.velocity_error * moment.velocity_error;
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : nan;
}

struct Level {
  double mean = 0.0;
  double deviation = 0.0;  ///< standard, of one frame
};

Level level(const std::vector<double>& values) {
  Level result;
  for (const double v : values) result.mean += v / static_cast<double>(values.size());
  for (const double v : values) result.deviation += std::pow(v - result.mean, 2);
  result.deviation = std::sqrt(result.deviation / static_cast<double>(values.size()));
  return result;
}

/// Mean velocities of one side over the last frames of a stretch.
std::vector<double> last_means(const dem::LocalData& data,
                               const Stretch& stretch,
                               double Moment::*mean) {
  const Frames frames = last_frames(data, stretch);
  std::vector<double> values;
  for (const Moment& moment : stretch.moments) {
    if (!frames.empty() && moment.time > frames.front().begin) values.push_back(moment.*mean);
  }
  return values;
}

/// One side on its way from the last level to the next.
struct Approach {
  Level last;
  double change = 0.0;
  double drift = 0.0;  ///< between the halves of what is taken for the last level
};

/// Absent with too few frames to tell. `before`: the stretch before; none: from rest.
std::optional<Approach> approach(const dem::LocalData& data,
                                 const Stretch& stretch,
                                 const Stretch* before,
                                 double Moment::*mean) {
  constexpr std::size_t least = 4;
  const std::vector<double> values = last_means(data, stretch, mean);
  if (values.size() < least) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  const double drift = level({middle, values.end()}).mean - level({values.begin(), middle}).mean;
  double first = 0.0;
  if (before != nullptr) first = level(last_means(data, *before, mean)).mean;
  const Level last = level(values);
  return Approach{last, std::abs(last.mean - first), std::abs(drift)};
}

/// Between the first frame in which the mean velocity is that close to its last level and the one
/// before.
dem::Estimate arrival(
    const Stretch& stretch, double Moment::*mean, double last, double within, double frame) {
  const auto there = std::ranges::find_if(
      stretch.moments, [&](const Moment& m) { return std::abs(m.*mean - last) <= within; });
  const double time = there == stretch.moments.end() ? stretch.end : there->time;
  return within_frame(time - stretch.begin, frame);
}

std::optional<TimeToSteady> time_to_steady(const dem::LocalData& data,
                                           const Stretch& stretch,
                                           const Stretch* before) {
  if (stretch.stop) return std::nullopt;
  const auto measured = approach(data, stretch, before, &Moment::measured_mean);
  const auto predicted = approach(data, stretch, before, &Moment::predicted_mean);
  if (!measured || !predicted) return std::nullopt;
  const double share = std::max(steady_share, 3.0 * measured->last.deviation / measured->change);
  const auto end = [&](double Moment::*mean, const Approach& side) {
    return arrival(stretch, mean, side.last.mean, share * side.change, frame_length(data));
  };
  for (const Approach& side : {*measured, *predicted}) {
    if (!(share < largest_share) || side.drift > share * side.change) return std::nullopt;
  }
  return TimeToSteady{
      end(&Moment::measured_mean, *measured), end(&Moment::predicted_mean, *predicted), share};
}

std::vector<Stretch> stretches_of(const dem::LocalData& data) {
  const std::vector<dem::TiltStep> tilts = tilts_of(data);
  if (data.frames.frames.empty() || (tilts.size() == 1 && !data.frames.from_rest)) return {};
  std::vector<Stretch> stretches;
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    Stretch stretch{.begin = tilts[k].time, .inclination = tilts[k].inclination};
    stretch.end = k + 1 < tilts.size() ? tilts[k + 1].time : data.frames.frames.back().end;
    if (k > 0) stretch.inclination_before = tilts[k - 1].inclination;
    stretches.push_back(std::move(stretch));
  }
  return stretches;
}

Change change_of(const Stretch& stretch, bool from_rest) {
  if (stretch.stop) return Change::arrest;
  return from_rest ? Change::start : Change::tilt_step;
}

}  // namespace

std::string_view name(Change change) {
  switch (change) {
    case Change::start:
      return "start";
    case Change::tilt_step:
      return "tilt step";
    case Change::arrest:
      break;
  }
  return "arrest";
}

std::vector<dem::TiltStep> tilts_of(const dem::LocalData& data) {
  std::vector<dem::TiltStep> tilts = data.conditions.tilts;
  if (tilts.empty()) return {{0.0, data.conditions.inclination}};
  const double end = data.frames.frames.empty() ? 0.0 : data.frames.frames.back().end;
  std::erase_if(tilts,
                [&](const dem::TiltStep& tilt) { return tilt.time > 0.0 && tilt.time >= end; });
  return tilts;
}

std::vector<Stretch> compare_in_time(const dem::LocalData& measured,
                                     const continuum::TransientChute& predicted) {
  const std::vector<dem::LocalRow> rows = measured_rows(measured).rows;
  std::vector<Stretch> stretches = stretches_of(measured);
  bool at_rest = measured.frames.from_rest;
  double norm_before = 0.0;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    Stretch& stretch = stretches[k];
    const double norm = end_norm(measured, rows, stretch);
    stretch.velocity_norm = std::max(norm, norm_before);
    norm_before = norm;
    add_moments(stretch, measured, rows, predicted.snapshots);
    stretch.stop = stopping_time(stretch, measured, predicted);
    stretch.change = change_of(stretch, at_rest);
    stretch.error = root_mean_square_error(stretch);
    stretch.to_steady = time_to_steady(measured, stretch, k > 0 ? &stretches[k - 1] : nullptr);
    at_rest = stretch.stop.has_value();
  }
  // a steady flow of its first tilt: nothing happens until the first change
  if (!measured.frames.from_rest && !stretches.empty()) stretches.erase(stretches.begin());
  return stretches;
}

}  // namespace grainlaw::calibration
