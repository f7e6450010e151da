#include "continuum/transient_segment.h"

#include <algorithm>
#include <cmath>

#include "continuum/shear_layer.h"
#include "continuum/yielding_layer.h"

namespace grainlaw::continuum {
namespace {

constexpr long largest_number_of_steps = 1'000'000;
/// A step too coarse for yield may leave stresses chattering about it, each jump the start of the
/// next; none of the flows that settle takes as many steps. A tighter tolerance ends it.
constexpr long steps_of_chatter = 20'000;
constexpr double settling_times_allowed = 5.0;
/// Elastic times after which what is left of a stop has died away: exp(-30) = 1e-13.
constexpr double elastic_times_to_rest = 30.0;

bool moves_backwards(const Motion& motion) {
  return std::ranges::any_of(motion.velocity, [](double u) { return u < 0.0; });
}

bool moves(const Motion& motion) {
  return std::ranges::any_of(motion.velocity, [](double u) { return u != 0.0; });
}

/// A layer that is at rest and held: its stress balances the weight.
Motion held(const DiscreteLayer& discrete, Motion motion) {
  std::ranges::fill(motion.velocity, 0.0);
  std::ranges::fill(motion.rate, 0.0);
  for (std::size_t k = 0; k < discrete.cells(); ++k)  // side walls carry what is above yield
    motion.stress[k] = std::min(discrete.layer().driving_stress(discrete.grid().face[k]),
                                discrete.curve(k).yield_stress);
  return motion;
}

/// The time the flow takes: a linear response, or that of a Bagnold flow of M^1.5 velocity.
double flow_time(const DiscreteLayer& discrete, const Motion& start, double relaxation_time) {
  const double gravity_time = std::pow(discrete.layer().mass, 1.5);
  if (relaxation_time == 0.0) relaxation_time = discrete.relaxation_time(start.rate);
  return relaxation_time > 0.0 ? std::min(relaxation_time, gravity_time) : gravity_time;
}

/// Twice the time in which a block as fast as the surface stops: its base yields at least, while
/// the layers above, once the base rests, brake each other no less for the stress they can carry.
double longest_stop(const DiscreteLayer& discrete, const Motion& start) {
  const Layer& layer = discrete.layer();
  const double brake = discrete.curve(discrete.cells() - 1).yield_stress / layer.mass - layer.sine;
  double fastest = 0.0;
  for (const double u : start.velocity) fastest = std::max(fastest, std::abs(u));
  return 2.0 * fastest / std::max(brake, 1e-9);
}

}  // namespace

bool may_rest_in_part(const Layer& layer) {
  if (layer.wall_drag > 0.0) return true;
  const auto* law = std::get_if<MuPhi>(&layer.law);
  if (!law) return std::get<GeneralisedBagnold>(layer.law).tau_c > 0.0;
  if (law->friction.exponent || law->friction.tabulated) return true;
  const bool cohesive = layer.grains.adhesion && (law->cohesion_friction || law->cohesion_stress);
  return cohesive || (law->softness_friction && layer.grains.stiffness);
}

Segment::Segment(const Layer& layer, const TransientOptions& options, Motion start)
    : verdict_(steady_verdict(layer)), options_(options), start_(std::move(start)) {
  require_continuous_yield(layer.law);
  DiscreteLayer discrete(layer, MassGrid(layer.mass, options.cells, options.grading));
  if (start_.velocity.empty()) start_ = discrete.rest();
  double relaxation_time = 0.0;
  if (flows(verdict_.outcome)) {
    relaxation_time = discrete.relaxation_time(discrete.steady().rate);
    settling_time_ = relaxation_time * std::log(1.0 / options.steady_residual);
  }
  delta_ = options.yield_regularisation;
  const bool yields_exactly =
      verdict_.outcome == Outcome::arrested || may_rest_in_part(layer) || moves_backwards(start_);
  if (delta_ == 0.0 && yields_exactly) {
    elastic_time_ = options.elastic_time > 0.0
                        ? options.elastic_time
                        : 5e-4 * flow_time(discrete, start_, relaxation_time);
    system_ = std::make_unique<YieldingLayer>(std::move(discrete), elastic_time_);
  } else {
    system_ = std::make_unique<ShearLayer>(std::move(discrete), delta_);
  }
  if (!moves(start_)) start_ = at_rest() ? held(this->discrete(), start_) : this->discrete().rest();
}

bool Segment::at_rest() const {
  return verdict_.outcome == Outcome::arrested && !moves(start_);
}

double Segment::time_needed() const {
  if (at_rest()) return 0.0;
  if (settling_time_ > 0.0) return settling_times_allowed * settling_time_;
  if (verdict_.outcome == Outcome::arrested)
    return longest_stop(discrete(), start_) + 2.0 * elastic_times_to_rest * elastic_time_;
  // Without a steady state, M^1.5 sets the scale: a Bagnold flow of I = 0.1 takes that long to
  // reach its speed I M^1.5 at an acceleration of 0.1.
  return 25.0 * std::pow(discrete().layer().mass, 1.5);
}

bool Segment::settled(double since, const OdeSolver& solver) const {
  return flows(verdict_.outcome) && since >= settling_time_ &&
         system_->largest_acceleration(solver.state(), solver.derivative()) <=
             options_.steady_residual * discrete().layer().sine;
}

Segment::Result Segment::rest(double begin, double end, const Observer& observer) const {
  observer.passed(end, [&](double) { return start_; });
  return {.end = End::arrested, .motion = start_, .time = begin, .stopped_at = begin};
}

Segment::Result Segment::run(double begin,
                             double end,
                             const std::function<bool()>& may_stop,
                             const Observer& observer,
                             SolverStatistics& statistics) const {
  if (at_rest()) return rest(begin, end, observer);
  if (!moves(start_) && elastic_time_ == 0.0) observer.happened(ChuteEvent::Kind::start, begin);
  const std::vector<double> state = system_->state(start_);
  OdeSolver solver(
      *system_,
      state,
      {.relative_tolerance = options_.relative_tolerance,
       // shear rates are of the order of 0.1, velocities and stresses of 10
       .absolute_tolerance = options_.absolute_tolerance * (elastic_time_ > 0.0 ? 100.0 : 1.0),
       .start_time = begin,
       .end_time = end,
       // above the largest friction I -> I_phi is part of accelerating for ever
       .stop_at_event = elastic_time_ > 0.0 || verdict_.outcome != Outcome::no_steady,
       .time_unit = " sqrt(d/g)"});
  Result result;
  try {
    result = integrate(solver, begin, may_stop, observer);
  } catch (const SolverError& error) {
    result.end = End::failed;
    result.failure = error.what();
  }
  result.time = solver.time();
  result.motion = system_->motion(solver.state());
  const std::vector<double> rate = solver.derivative();
  result.largest_acceleration = system_->largest_acceleration(solver.state(), rate);
  result.surface_acceleration = system_->acceleration(solver.state(), rate, 0);
  statistics += solver.statistics();
  if (result.end == End::arrested) {
    result.motion = held(discrete(), std::move(result.motion));
    result.largest_acceleration = result.surface_acceleration = 0.0;
    observer.passed(end, [&](double) { return result.motion; });
  }
  return result;
}

Segment::Result Segment::integrate(OdeSolver& solver,
                                   double begin,
                                   const std::function<bool()>& may_stop,
                                   const Observer& observer) const {
  std::optional<double> stopped;
  bool yielded = moves(start_);
  double next_tightening = begin + 2.0 * settling_time_;
  const auto motion_at = [&](double time) { return system_->motion(solver.interpolate(time)); };
  for (long steps = 0; steps < largest_number_of_steps; ++steps) {
    const auto last = solver.step();
    observer.passed(solver.time(), motion_at);
    observer.mean_velocity(solver.time(), system_->mean_velocity(solver.state()));
    if (last == OdeSolver::Step::event) {
      if (solver.event().index == TransientSystem::dense_event) {
        observer.happened(ChuteEvent::Kind::dense_state_lost, solver.time());
        return {.end = End::dense_state_lost};
      }
      if (solver.event().rising) {
        if (!yielded) observer.happened(ChuteEvent::Kind::start, solver.time());
        yielded = true;
        stopped.reset();
      } else {
        stopped = solver.time();
      }
    }
    if (stopped && solver.time() >= *stopped + elastic_times_to_rest * elastic_time_) {
      observer.happened(ChuteEvent::Kind::arrest, *stopped);
      return {.end = End::arrested, .stopped_at = *stopped};
    }
    const bool at_end = last == OdeSolver::Step::end;
    if ((may_stop() || at_end) && settled(solver.time() - begin, solver))
      return {.end = End::steady};
    if (at_end) return {.end = End::time_limit};
    if (steps % steps_of_chatter == steps_of_chatter - 1) solver.tighten(0.1);
    // what is left after so long is the noise of the solver, not the relaxation of the flow
    if (may_stop() && solver.time() >= next_tightening &&
        next_tightening < begin + settling_times_allowed * settling_time_) {
      solver.tighten(0.1);
      next_tightening += settling_time_;
    }
  }
  return {.end = End::step_limit};
}

}  // namespace grainlaw::continuum
