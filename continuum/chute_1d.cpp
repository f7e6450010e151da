#include "continuum/chute_1d.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "continuum/layer.h"
#include "continuum/ode_solver.h"
#include "continuum/range_flags.h"
#include "continuum/shear_layer.h"
#include "continuum/steady_profile.h"

namespace grainlaw::continuum {
namespace {

constexpr long largest_number_of_steps = 1'000'000;
constexpr double settling_times_allowed = 5.0;
constexpr double steady_within = 0.01;  // of the final mean velocity

void require(bool holds, const char* name, double value, const char* bound) {
  if (!holds) throw std::invalid_argument(fmt::format("{} = {} must be {}", name, value, bound));
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
  require(options.steady_residual > 0.0 && options.steady_residual < 1.0,
          "steady_residual",
          options.steady_residual,
          "between 0 and 1");
  require(options.time_limit >= 0.0, "time_limit", options.time_limit, "0 (chosen) or positive");
  // a smaller delta lets the solver report success with a wrong flow
  const double least = 100.0 * options.absolute_tolerance;
  require(options.yield_regularisation == 0.0 || options.yield_regularisation >= least,
          "yield_regularisation",
          options.yield_regularisation,
          "0 (chosen) or at least 100 absolute_tolerance");
}

/// Output times in solver units, ascending.
std::vector<double> sorted_times(const TransientOptions& options, double unit) {
  std::vector<double> times;
  for (const double time : options.output_times) {
    require(std::isfinite(time) && time >= 0.0, "output time", time, "finite and not negative");
    times.push_back(time / unit);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// delta of the regularised yield stress; 0 where none is needed.
double regularisation(const Layer& layer, const TransientOptions& options, Outcome ahead) {
  if (!needs_regularisation(layer)) return 0.0;
  if (options.yield_regularisation > 0.0) return options.yield_regularisation;
  const double tau = layer.driving_stress(layer.mass);
  const double q = flows(ahead) ? layer.curve(layer.mass).scaled_rate(tau).value() : 1.0;
  return std::max(1e-4 * q, 100.0 * options.absolute_tolerance);
}

/// Time a linear response needs to fall to the steady residual, in units d = rho_p = g = 1; none
/// where no steady state lies ahead. A run close to repose has a small residual from the start, so
/// the residual alone would not show that it is steady.
double settling_time(const ShearLayer& system, Outcome ahead, double residual) {
  if (!flows(ahead)) return 0.0;
  return system.relaxation_time(system.steady_state()) * std::log(1.0 / residual);
}

struct MeanVelocity {
  double time;
  double value;
};

/// When the mean velocity came close to its last value to stay. Between two steps its distance from
/// there is taken to decay exponentially, as every start ends.
double time_to_steady(const std::vector<MeanVelocity>& history) {
  const double last = history.back().value;
  const auto distance = [&](std::size_t i) { return std::abs(history[i].value - last); };
  std::size_t i = history.size() - 1;
  while (i > 0 && distance(i - 1) <= steady_within * last) --i;
  if (i == 0) return 0.0;
  const double share =
      std::log(distance(i - 1) / (steady_within * last)) / std::log(distance(i - 1) / distance(i));
  return history[i - 1].time + share * (history[i].time - history[i - 1].time);
}

enum class End { steady, dense_state_lost, time_limit, step_limit };

/// One start, in units d = rho_p = g = 1 until the result is filled.
struct Start {
  const RheologyTable& table;
  const Layer& layer;
  const TransientOptions& options;
  const Verdict verdict;
  const double delta;
  const ShearLayer system;
  const double settling_time;
  const std::vector<double> output_times;
  TransientChute result{};
  std::vector<MeanVelocity> history{{0.0, 0.0}};  // after every step towards a steady flow

  void take_verdict();
  void rest();
  void flow();

 private:
  double time_limit() const;
  End integrate(OdeSolver& solver);
  bool settled(const OdeSolver& solver) const;
  void take_snapshots(const OdeSolver& solver);
  void take_snapshot(double time, const Profile& profile);
  Profile profile(std::span<const double> q) const;
  Outcome outcome(End end) const;
  std::string text(End end, std::span<const double> q, const Profile& last) const;
  std::string regularisation_text(End end, std::span<const double> q, const Profile& last) const;
};

double Start::time_limit() const {
  if (options.time_limit > 0.0) return options.time_limit / layer.units.time;
  // Without a steady state, M^1.5 sets the scale: a Bagnold flow of I = 0.1 takes that long to
  // reach its speed I M^1.5 at an acceleration of 0.1.
  const double chosen = flows(verdict.outcome) ? settling_times_allowed * settling_time
                                               : 25.0 * std::pow(layer.mass, 1.5);
  return output_times.empty() ? chosen : std::max(chosen, output_times.back());
}

Profile Start::profile(std::span<const double> q) const {
  return system.profile(q, delta > 0.0 ? system.plug_edge(q).mass : 0.0);
}

void Start::take_snapshot(double time, const Profile& profile) {
  result.snapshots.push_back({time * layer.units.time, in_case_units(layer, profile)});
}

/// Those that the last step has passed.
void Start::take_snapshots(const OdeSolver& solver) {
  while (result.snapshots.size() < output_times.size()) {
    const double time = output_times[result.snapshots.size()];
    if (time > solver.time()) return;
    take_snapshot(time, time == 0.0 ? system.at_rest() : profile(solver.interpolate(time)));
  }
}

/// All there is to say where the law has no answer: neither a flow nor rest.
void Start::take_verdict() {
  result.answer = {.outcome = verdict.outcome,
                   .text = verdict.text,
                   .out_of_domain = range_flags(layer, table, {})};
}

/// The layer stays as it is, held by its yield stress.
void Start::rest() {
  take_verdict();
  const Profile still = system.at_rest();
  for (const double time : output_times) take_snapshot(time, still);
  result.final_profile = in_case_units(layer, still);
}

bool Start::settled(const OdeSolver& solver) const {
  return flows(verdict.outcome) && solver.time() >= settling_time &&
         system.largest_acceleration(solver.state()) <= options.steady_residual * layer.sine;
}

End Start::integrate(OdeSolver& solver) {
  double next_tightening = 2.0 * settling_time;
  for (long steps = 0; steps < largest_number_of_steps; ++steps) {
    const auto last = solver.step();
    take_snapshots(solver);
    if (flows(verdict.outcome))
      history.push_back({solver.time(), system.mean_velocity(solver.state())});
    if (last == OdeSolver::Step::event) return End::dense_state_lost;
    const bool may_stop =
        options.stop_when_steady && result.snapshots.size() == output_times.size();
    if ((may_stop || last == OdeSolver::Step::end) && settled(solver)) return End::steady;
    if (last == OdeSolver::Step::end) return End::time_limit;
    // what is left after so long is the noise of the solver, not the relaxation of the flow
    if (may_stop && solver.time() >= next_tightening &&
        next_tightening < settling_times_allowed * settling_time) {
      solver.tighten(0.1);
      next_tightening += settling_time;
    }
  }
  return End::step_limit;
}

Outcome Start::outcome(End end) const {
  if (end == End::steady) return verdict.outcome;
  if (end == End::dense_state_lost) return Outcome::no_dense_state;
  if (end == End::step_limit) return Outcome::not_converged;
  if (verdict.outcome == Outcome::no_steady) return Outcome::accelerating;
  if (!options.stop_when_steady) return Outcome::time_reached;
  return flows(verdict.outcome) ? Outcome::not_converged : verdict.outcome;
}

std::string Start::text(End end, std::span<const double> q, const Profile& last) const {
  std::string text = fmt::format(
      "{}; at the end the largest |du/dt| is {:.2g} g sin(theta), the surface gains {:.3g} g, I is "
      "at most {:.4g}",
      verdict.text,
      result.residual,
      system.surface_acceleration(q),
      system.largest_inertial_number(q));
  if (options.cells < 8) text += fmt::format("; only {} cells: a coarse answer", options.cells);
  if (delta > 0.0) text += regularisation_text(end, q, last);
  return text;
}

std::string Start::regularisation_text(End end,
                                       std::span<const double> q,
                                       const Profile& last) const {
  std::string text = fmt::format("; yield stress regularised with delta = {:.1e}", delta);
  if (end == End::steady) {
    const Profile exact = steady_profile(layer, verdict.plug_mass, {.rows = 2});
    text += fmt::format(", which with the grid changes the surface velocity by {:+.2g} %",
                        100.0 * (last.surface_velocity / exact.surface_velocity - 1.0));
  }
  if (const auto edge = system.plug_edge(q); edge.mass > 0.0)
    text += fmt::format(", plug edge at {:.4g} +- {:.1g} of the mass",
                        edge.mass / layer.mass,
                        edge.uncertainty / layer.mass);
  return text;
}

void Start::flow() {
  const std::vector<double> rest(system.size(), 0.0);
  OdeSolver solver(system,
                   rest,
                   {.relative_tolerance = options.relative_tolerance,
                    .absolute_tolerance = options.absolute_tolerance,
                    .end_time = time_limit(),
                    // above the largest friction I -> I_phi is part of accelerating for ever
                    .stop_at_event = verdict.outcome != Outcome::no_steady,
                    .time_unit = " sqrt(d/g)"});
  const End end = integrate(solver);
  const auto q = solver.state();
  const Profile last = profile(q);
  result.final_profile = in_case_units(layer, last);
  result.end_time = solver.time() * layer.units.time;
  if (end == End::steady) result.time_to_steady = time_to_steady(history) * layer.units.time;
  result.residual = system.largest_acceleration(q) / layer.sine;
  result.statistics = solver.statistics();
  result.answer = {.outcome = outcome(end),
                   .text = text(end, q, last),
                   .out_of_domain = range_flags(layer, table, last),
                   .condition_number = condition_number(layer, last.rows.front().shear_stress)};
}

}  // namespace

TransientChute start_from_rest(const RheologyTable& table,
                               const ChuteCase& chute,
                               const TransientOptions& options) {
  const auto started = std::chrono::steady_clock::now();
  validate(table);
  const Layer layer = make_layer(table, chute);
  check(options);
  const Verdict verdict = steady_verdict(layer);
  const double delta = regularisation(layer, options, verdict.outcome);
  const ShearLayer system(layer, MassGrid(layer.mass, options.cells, options.grading), delta);
  Start start{.table = table,
              .layer = layer,
              .options = options,
              .verdict = verdict,
              .delta = delta,
              .system = system,
              .settling_time = settling_time(system, verdict.outcome, options.steady_residual),
              .output_times = sorted_times(options, layer.units.time)};
  start.result.settling_time = start.settling_time * layer.units.time;
  if (no_friction_left(layer))
    start.take_verdict();
  else if (start.verdict.outcome == Outcome::arrested)
    start.rest();
  else
    start.flow();
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
  start.result.statistics.wall_seconds = taken.count();
  return std::move(start.result);
}

}  // namespace grainlaw::continuum
