#include "continuum/chute_1d.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "continuum/layer.h"
#include "continuum/range_flags.h"
#include "continuum/steady_profile.h"
#include "continuum/transient_segment.h"

namespace grainlaw::continuum {
namespace {

constexpr double steady_within = 0.01;  // of the change of the mean velocity

void require(bool holds, const char* name, double value, const char* bound) {
  if (!holds) throw std::invalid_argument(fmt::format("{} = {} must be {}", name, value, bound));
}

void check_tilts(const TransientOptions& options) {
  double previous = 0.0;
  for (const TiltStep& step : options.tilts) {
    require(std::isfinite(step.time) && step.time > previous,
            "tilt time",
            step.time,
            "later than the one before, and than 0");
    require(std::abs(step.inclination) < 0.5 * std::numbers::pi,
            "tilt",
            step.inclination,
            "between -pi/2 and pi/2");
    previous = step.time;
  }
}

void check(const TransientOptions& options) {
  require(options.cells >= 2, "cells", options.cells, "at least 2");
  require(options.grading >= 1.0 && options.grading <= 4.0,
          "grading",
          options.grading,
          "between 1 and 4");
  require(options.relative_tolerance > 0.0 && options.relative_tolerance <= 0.1,
          "relative_tolerance",
          options.relative_tolerance,
          "positive and at most 0.1");
  require(options.absolute_tolerance > 0.0,
          "absolute_tolerance",
          options.absolute_tolerance,
          "positive");
  const double delta = options.yield_regularisation;
  require(delta == 0.0 || delta >= 100.0 * options.absolute_tolerance,
          "yield_regularisation",
          delta,
          "at least 100 times the absolute tolerance: below, the solver does not resolve it");
  require(options.elastic_time >= 0.0, "elastic_time", options.elastic_time, "not negative");
  require(options.time_limit >= 0.0, "time_limit", options.time_limit, "not negative");
  require(options.steady_residual > 0.0, "steady_residual", options.steady_residual, "positive");
  for (const double time : options.output_times)
    require(std::isfinite(time) && time >= 0.0, "output time", time, "finite and not negative");
  check_tilts(options);
}

/// All times in multiples of `unit`, output times ascending.
TransientOptions in_units_of(TransientOptions options, double unit) {
  for (double& time : options.output_times) time /= unit;
  for (TiltStep& step : options.tilts) step.time /= unit;
  options.time_limit /= unit;
  options.elastic_time /= unit;
  std::sort(options.output_times.begin(), options.output_times.end());
  return options;
}

struct MeanVelocity {
  double time;
  double value;
};

/// When the mean velocity came close to its last value to stay. Between two steps its distance from
/// there is taken to decay exponentially, as every approach ends.
double time_to_steady(const std::vector<MeanVelocity>& history) {
  const double begin = history.front().time;
  const double last = history.back().value;
  const auto distance = [&](std::size_t i) { return std::abs(history[i].value - last); };
  std::size_t i = history.size() - 1;
  while (i > 0 && distance(i - 1) <= steady_within * last) --i;
  if (i == 0) return 0.0;
  const double share =
      std::log(distance(i - 1) / (steady_within * last)) / std::log(distance(i - 1) / distance(i));
  return history[i - 1].time + share * (history[i].time - history[i - 1].time) - begin;
}

/// One run through all tilts, in units d = rho_p = g = 1 until the result is filled.
class Transient {
 public:
  Transient(const RheologyTable& table, const ChuteCase& chute, const TransientOptions& options)
      : table_(table),
        chute_(chute),
        layer_(make_layer(table, chute)),
        options_(in_units_of(options, layer_.units.time)) {}

  TransientChute run();

 private:
  Layer layer_at(double inclination) const;
  Motion beginning() const;
  double end_of(std::size_t tilt, const Segment& segment) const;
  void follow(std::size_t tilt, Motion& motion);
  Segment::Observer observer(const Segment& segment);
  void take_snapshots(const DiscreteLayer& discrete,
                      double time,
                      const std::function<Motion(double)>& motion_at);
  void take_verdict(const Verdict& verdict);
  void finish(const Segment& segment, const Segment::Result& end);
  Outcome outcome(const Segment& segment, End end) const;
  std::optional<double> answer_time(Outcome outcome) const;
  std::string text(const Segment& segment, const Segment::Result& end, const Profile& last) const;
  std::string regularised(const Segment& segment, const Segment::Result& end) const;

  const RheologyTable& table_;
  ChuteCase chute_;
  Layer layer_;  // at the tilt that is being followed
  TransientOptions options_;
  double begin_ = 0.0;  // of that tilt
  bool over_ = false;
  TransientChute result_{};
  std::vector<MeanVelocity> history_;  // at that tilt, after every step
};

Layer Transient::layer_at(double inclination) const {
  ChuteCase chute = chute_;
  chute.inclination = inclination;
  return make_layer(table_, chute);
}

/// Empty: at rest.
Motion Transient::beginning() const {
  if (!options_.inclination_before) return {};
  const Layer before = layer_at(*options_.inclination_before);
  const Verdict verdict = steady_verdict(before);
  if (verdict.outcome == Outcome::arrested) return {};
  if (!flows(verdict.outcome))
    throw std::invalid_argument("there is no steady flow to begin with at inclination_before: " +
                                verdict.text);
  Motion motion =
      DiscreteLayer(before, MassGrid(before.mass, options_.cells, options_.grading)).steady();
  const double direction = before.direction * layer_.direction;
  for (double& u : motion.velocity) u *= direction;
  for (double& tau : motion.stress) tau *= direction;
  return motion;
}

double Transient::end_of(std::size_t tilt, const Segment& segment) const {
  if (tilt < options_.tilts.size()) return options_.tilts[tilt].time;
  if (options_.time_limit > 0.0) return std::max(options_.time_limit, begin_);
  const double chosen = begin_ + segment.time_needed();
  return options_.output_times.empty() ? chosen : std::max(chosen, options_.output_times.back());
}

/// Those that a step has passed.
void Transient::take_snapshots(const DiscreteLayer& discrete,
                               double time,
                               const std::function<Motion(double)>& motion_at) {
  while (result_.snapshots.size() < options_.output_times.size()) {
    const double next = options_.output_times[result_.snapshots.size()];
    if (next > time) return;
    result_.snapshots.push_back(
        {next * layer_.units.time, in_case_units(layer_, discrete.profile(motion_at(next)))});
  }
}

Segment::Observer Transient::observer(const Segment& segment) {
  return {.passed =
              [this, &segment](double time, const auto& motion_at) {
                take_snapshots(segment.discrete(), time, motion_at);
              },
          .happened =
              [this](ChuteEvent::Kind kind, double time) {
                result_.events.push_back({kind, time * layer_.units.time});
              },
          .mean_velocity =
              [this, &segment](double time, double value) {
                if (flows(segment.verdict().outcome)) history_.push_back({time, value});
              }};
}

/// All there is to say where the law has no answer: neither a flow nor rest.
void Transient::take_verdict(const Verdict& verdict) {
  result_.answer = {.outcome = verdict.outcome,
                    .text = verdict.text,
                    .out_of_domain = range_flags(layer_, table_, {})};
  over_ = true;
}

/// From the motion at the beginning of a tilt to that at its end.
void Transient::follow(std::size_t tilt, Motion& motion) {
  const Segment segment(layer_, options_, motion);
  if (no_friction_left(layer_)) return take_verdict(segment.verdict());
  const bool last = tilt == options_.tilts.size();
  history_ = {{begin_, motion.velocity.empty() ? 0.0 : segment.discrete().mean_velocity(motion)}};
  const auto may_stop = [&] {
    return last && options_.stop_when_steady &&
           result_.snapshots.size() == options_.output_times.size();
  };
  const double end = end_of(tilt, segment);
  auto ended = segment.run(begin_, end, may_stop, observer(segment), result_.statistics);
  result_.settling_time = segment.settling_time() * layer_.units.time;
  over_ = last || ended.end == End::dense_state_lost || ended.end == End::failed ||
          ended.end == End::step_limit;
  if (over_) finish(segment, ended);
  motion = std::move(ended.motion);
  begin_ = end;
}

Outcome Transient::outcome(const Segment& segment, End end) const {
  const Outcome ahead = segment.verdict().outcome;
  switch (end) {
    case End::steady:
      return ahead;
    case End::arrested:
      return Outcome::arrested;
    case End::dense_state_lost:
      return ahead == Outcome::no_steady ? Outcome::accelerating : Outcome::no_dense_state;
    case End::step_limit:
    case End::failed:
      return Outcome::not_converged;
    case End::time_limit:
      break;
  }
  if (ahead == Outcome::no_steady) return Outcome::accelerating;
  const bool waited = !result_.events.empty() &&
                      result_.events.back().kind == ChuteEvent::Kind::start &&
                      result_.events.back().time > 0.0 && !options_.tilts.empty();
  if (waited) return Outcome::started;
  if (!options_.stop_when_steady) return Outcome::time_reached;
  return ahead == Outcome::no_dense_state ? ahead : Outcome::not_converged;
}

std::optional<double> Transient::answer_time(Outcome outcome) const {
  if (outcome == Outcome::started) return result_.events.back().time;
  if (outcome != Outcome::arrested) return std::nullopt;
  return result_.events.empty() ? 0.0 : result_.events.back().time;
}

std::string Transient::text(const Segment& segment,
                            const Segment::Result& end,
                            const Profile& last) const {
  std::string text = segment.verdict().text;
  if (end.end == End::failed) text += "; " + end.failure;
  if (end.end == End::arrested) return text;
  text += fmt::format(
      "; at the end the largest |du/dt| is {:.2g} g sin(theta), the surface gains {:.3g} g, I is "
      "at most {:.4g}",
      result_.residual,
      end.surface_acceleration,
      segment.discrete().largest_inertial_number(end.motion.rate));
  if (options_.cells < 8) text += fmt::format("; only {} cells: a coarse answer", options_.cells);
  if (segment.regularisation() > 0.0) text += regularised(segment, end);
  if (last.plug_mass > 0.0 && last.plug_mass < layer_.mass) {
    const auto edge = segment.discrete().plug_edge(end.motion.stress);
    text += fmt::format("; plug edge at {:.4g} +- {:.1g} of the mass",
                        edge.mass / layer_.mass,
                        edge.uncertainty / layer_.mass);
  }
  return text;
}

std::string Transient::regularised(const Segment& segment, const Segment::Result& end) const {
  std::string text =
      fmt::format("; yield stress regularised with delta = {:.1e}", segment.regularisation());
  const double surface = segment.discrete().profile(end.motion).surface_velocity;
  if (segment.verdict().outcome == Outcome::arrested)
    return text +
           fmt::format(", so it never stops: the surface creeps at {:.2g} sqrt(g d)", surface);
  if (end.end == End::steady) {
    const Profile exact = steady_profile(layer_, segment.verdict().plug_mass, {.rows = 2});
    text += fmt::format(", which with the grid changes the surface velocity by {:+.2g} %",
                        100.0 * (surface / exact.surface_velocity - 1.0));
  }
  return text;
}

void Transient::finish(const Segment& segment, const Segment::Result& end) {
  const Profile last = segment.discrete().profile(end.motion);
  const Verdict& verdict = segment.verdict();
  result_.final_profile = in_case_units(layer_, last);
  result_.end_time = end.time * layer_.units.time;
  result_.residual = layer_.sine > 0.0 ? end.largest_acceleration / layer_.sine : 0.0;
  if (end.end == End::steady) result_.time_to_steady = time_to_steady(history_) * layer_.units.time;
  if (flows(verdict.outcome))
    result_.quadrature_surface_velocity =
        in_case_units(layer_, steady_profile(layer_, verdict.plug_mass, {.rows = 2}))
            .surface_velocity;
  result_.answer = {.outcome = outcome(segment, end.end),
                    .text = text(segment, end, last),
                    .out_of_domain = range_flags(layer_, table_, last),
                    .condition_number = condition_number(layer_, last.rows.front().shear_stress)};
  result_.answer.time = answer_time(result_.answer.outcome);
}

TransientChute Transient::run() {
  Motion motion = beginning();
  for (std::size_t tilt = 0; !over_; ++tilt) {
    follow(tilt, motion);
    if (over_) break;
    const double direction = layer_.direction;
    layer_ = layer_at(options_.tilts[tilt].inclination);
    if (layer_.direction != direction) {
      for (double& u : motion.velocity) u = -u;
      for (double& tau : motion.stress) tau = -tau;
    }
  }
  return std::move(result_);
}

}  // namespace

std::string_view name(ChuteEvent::Kind kind) {
  switch (kind) {
    case ChuteEvent::Kind::start:
      return "START";
    case ChuteEvent::Kind::arrest:
      return "ARREST";
    case ChuteEvent::Kind::dense_state_lost:
      break;
  }
  return "DENSE_STATE_LOST";
}

TransientChute transient_chute(const RheologyTable& table,
                               const ChuteCase& chute,
                               const TransientOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  validate(table);
  check(options);
  TransientChute result = Transient(table, chute, options).run();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
  result.statistics.wall_seconds = taken.count();
  return result;
}

}  // namespace grainlaw::continuum
