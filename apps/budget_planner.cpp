#include "apps/budget_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/compare_runs.h"
#include "calibration/box_points.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

using calibration::Candidate;
using calibration::Observation;
using calibration::State;

/// Part of the time after the first round that goes to lack of fit and repeats.
constexpr double exploring_part = 0.3;
/// Puts candidates that do not fit a run behind all that do.
constexpr double too_dear = 1e9;
/// Of the time left, at least for a round: few long rounds lose less at their ends than many.
constexpr double least_round = 1.0 / 16.0;
/// Of the longest run of a round; with less of the round left a process gets no further one.
constexpr double least_rest = 0.25;
/// Part of a run that may be warm-up where the time is enough for a further round.
constexpr double warm_up_part = 0.2;

std::vector<std::vector<double>> places_of(const std::vector<BudgetCandidate>& candidates) {
  std::vector<std::vector<double>> places;
  for (const BudgetCandidate& one : candidates) places.push_back(one.place);
  return places;
}

}  // namespace

BudgetPlanner::BudgetPlanner(const io::Campaign& campaign,
                             std::vector<BudgetCandidate> candidates,
                             int processes)
    : campaign_(campaign), candidates_(std::move(candidates)), processes_(processes) {
  const auto places = places_of(candidates_);
  order_ = calibration::spread_order(places);
  first_runs_ = static_cast<std::size_t>(2 * calibration::varied_coordinates(places) + 1);
}

bool BudgetPlanner::learn(const continuum::RheologyTable& table,
                          std::span<const MeasuredRun> runs) {
  table_ = table;
  told_.clear();
  for (const MeasuredRun& run : runs) {
    for (std::size_t k = 0; k < candidates_.size() && run.fitted; ++k) {
      const BudgetCandidate& candidate = candidates_[k];
      if (candidate.planned.condition != run.condition) continue;
      const double averaged = (run.data.window.end - run.data.window.begin) / candidate.unit;
      const Observation one = observation(run.data);
      if (one.error > 0.0) told_.push_back({k, one, averaged});
    }
  }
  if (told_.empty()) table_.reset();
  return table_.has_value();
}

double BudgetPlanner::shortest(std::size_t candidate) const {
  return candidates_[candidate].seconds(candidates_[candidate].least);
}

std::vector<std::size_t> BudgetPlanner::spread(const std::vector<std::size_t>& pool) const {
  std::vector<std::vector<double>> places;
  for (const std::size_t k : pool) places.push_back(candidates_[k].place);
  std::vector<std::size_t> chosen;
  for (const std::size_t k : calibration::spread_order(places)) chosen.push_back(pool[k]);
  chosen.resize(std::min(chosen.size(), first_runs_));
  return chosen;
}

/// `processes` at a time, in their order.
double BudgetPlanner::wall_seconds(const std::vector<std::size_t>& chosen) const {
  std::vector<double> busy(static_cast<std::size_t>(processes_), 0.0);
  for (const std::size_t k : chosen) {
    *std::ranges::min_element(busy) += shortest(k);
  }
  return pace_ * *std::ranges::max_element(busy);
}

FirstRound BudgetPlanner::first_round(double seconds_left) const {
  const auto cost = [&](std::size_t k) { return shortest(k); };
  FirstRound round;
  for (std::vector<std::size_t> pool = order_; pool.size() >= fewest_runs;) {
    std::vector<std::size_t> chosen = spread(pool);
    // The longest first: the others fill the time beside it.
    std::ranges::sort(chosen, std::greater{}, cost);
    round.seconds = wall_seconds(chosen);
    if (round.seconds <= first_part * seconds_left) {
      for (const std::size_t k : chosen) round.runs.push_back({k, candidates_[k].least, "spread"});
      break;
    }
    pool.erase(std::ranges::max_element(pool, {}, cost));
  }
  return round;
}

bool BudgetPlanner::any_fits(double seconds) const {
  return std::ranges::any_of(candidates_, [&](const auto& one) { return one.fits(seconds); });
}

/// Of the candidates that fit the time left, averaged for as long as one run may be.
double BudgetPlanner::longest_run(double seconds_left) const {
  double longest = 0.0;
  for (const BudgetCandidate& one : candidates_) {
    if (one.fits(seconds_left)) longest = std::max(longest, one.seconds(one.most));
  }
  return longest;
}

/// Half of what is left, or all of it where warm-ups would take too much of the half. 0: no run
/// fits. Without a law yet nothing is lost by runs that may be cut off.
double BudgetPlanner::next_run_seconds(double all) const {
  const auto worthwhile = [&](const BudgetCandidate& one) {
    const double warm_up = one.warm_up * one.seconds_per_unit;
    return !one.fits(all) || (one.fits(0.5 * all) && warm_up <= warm_up_part * 0.5 * all);
  };
  if (!any_fits(all)) return table_ ? 0.0 : all;
  return std::ranges::all_of(candidates_, worthwhile) ? 0.5 * all : all;
}

std::vector<PlannedSpending> BudgetPlanner::next_round(double seconds_left) {
  const double all = seconds_left / pace_;
  const double allowed = next_run_seconds(all);
  std::vector<PlannedSpending> runs;
  if (!(allowed > 0.0)) return runs;
  // Where no run fits, one that may be cut off takes all that is left.
  const double longest = any_fits(all) ? std::min(allowed, longest_run(all)) : allowed;
  const double seconds = std::max(longest, std::min(allowed, least_round * all));
  std::vector<Told> told = told_;
  std::vector<double> busy(static_cast<std::size_t>(processes_), 0.0);
  while (true) {
    double& until = *std::ranges::min_element(busy);  // of the process that is free first
    const double rest = seconds - until;
    if (rest < least_rest * longest || (until > 0.0 && !any_fits(rest))) break;
    const bool exploring = !table_ || explored_ < exploring_part * (later_ + rest);
    const std::size_t k = exploring ? least_run(rest, runs) : most_wanted(rest, seconds, told);
    const BudgetCandidate& one = candidates_[k];
    const double averaging = std::max(one.least, std::min(one.most, one.averaging(rest)));
    if (!std::isfinite(averaging)) break;  // no candidate is left
    runs.push_back({k, averaging, exploring ? "lack of fit" : "largest gain"});
    const double taken = std::min(rest, one.seconds(averaging));  // what is longer is cut off
    until += taken;
    later_ += taken;
    explored_ += exploring ? taken : 0.0;
    if (table_) told.push_back(expected(k, averaging));
  }
  return runs;
}

/// Of those with the fewest runs the one that is farthest from the others, dearer ones last.
std::size_t BudgetPlanner::least_run(double seconds,
                                     const std::vector<PlannedSpending>& chosen) const {
  const auto runs = [&](std::size_t k) {
    const auto now = std::ranges::count(chosen, k, &PlannedSpending::candidate);
    const double few = static_cast<double>(candidates_[k].tries() + now);
    return candidates_[k].fits(seconds) ? few : few + candidates_[k].least * too_dear;
  };
  return *std::ranges::min_element(order_, {}, runs);
}

/// The run is the one that this many seconds allow.
std::size_t BudgetPlanner::most_wanted(double seconds,
                                       double round_seconds,
                                       const std::vector<Told>& told) const {
  std::vector<Candidate> open;
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const BudgetCandidate& one = candidates_[k];
    const std::optional<State> state = state_of(one);
    if (!state || !one.fits(seconds)) continue;
    open.push_back({.state = *state,
                    .run = std::min(seconds, one.seconds(one.most)),
                    .warm_up = one.warm_up * one.seconds_per_unit,
                    .noise = noise(k) * std::sqrt(one.seconds_per_unit)});
    places.push_back(k);
  }
  if (open.empty()) return least_run(seconds, {});
  const std::vector<std::string> names = calibration::friction_coefficients(*table_);
  return places[calibration::most_wanted(*table_,
                                         names,
                                         open,
                                         target_gradients(names, open),
                                         information(names, told),
                                         round_seconds * processes_)];
}

std::vector<double> BudgetPlanner::information(const std::vector<std::string>& names,
                                               const std::vector<Told>& told) const {
  std::vector<Observation> observations;
  for (const Told& one : told) observations.push_back(one.observation);
  return calibration::information_of(*table_, names, observations);
}

dem::Estimate BudgetPlanner::surface_velocity(double tilt) const {
  dem::Estimate velocity = calibration::surface_velocity(*table_, target(tilt));
  const std::vector<std::string> names = calibration::friction_coefficients(*table_);
  const auto gradient = calibration::velocity_gradient(*table_, names, target(tilt));
  if (gradient.empty()) return velocity;
  const std::vector<std::vector<double>> one{gradient};
  const double variance = calibration::mean_variance(one, information(names, told_));
  if (std::isfinite(variance)) {
    velocity.error = std::max(velocity.error, velocity.value * std::sqrt(variance));
  }
  return velocity;
}

/// Of the targets that flow; where none does, mu at every candidate.
std::vector<std::vector<double>> BudgetPlanner::target_gradients(
    const std::vector<std::string>& names, std::span<const Candidate> open) const {
  std::vector<std::vector<double>> gradients;
  for (const double tilt : campaign_.predict_tilts) {
    std::vector<double> one = calibration::velocity_gradient(*table_, names, target(tilt));
    if (!one.empty()) gradients.push_back(std::move(one));
  }
  if (!gradients.empty()) return gradients;
  for (const Candidate& one : open) {
    gradients.push_back(calibration::friction_gradient(*table_, names, one.state));
  }
  return gradients;
}

continuum::ChuteCase BudgetPlanner::target(double tilt) const {
  return chute_case(dem::conditions(io::scene_at(campaign_, tilt).scene));
}

/// Where a candidate lies on the law; a chute that rests lies nowhere.
std::optional<State> BudgetPlanner::state_of(const BudgetCandidate& candidate) const {
  const dem::Scene& scene = candidate.planned.file.scene;
  if (const auto* chute = std::get_if<dem::Chute>(&scene.geometry)) {
    const auto& law = std::get<continuum::MuPhi>(table_->law).friction;
    const double I = continuum::inertial_number_of(law, std::tan(chute->inclination));
    if (!(I > 0.0) || !std::isfinite(I)) return std::nullopt;
    return State{.inertial_number = I};
  }
  const io::BoxState box = io::box_state(scene);
  return State{box.inertial_number, box.softness, box.bond_number};
}

/// Effective error of mu after averaging over one unit, as the nearest candidates with runs show;
/// runs that were not steady told nothing.
double BudgetPlanner::noise(std::size_t k) const {
  double nearest = std::numeric_limits<double>::infinity();
  double sum = 0.0;
  double count = 0.0;
  for (const Told& one : told_) {
    double apart = 0.0;
    for (std::size_t c = 0; c < candidates_[k].place.size(); ++c) {
      apart = std::hypot(apart, candidates_[k].place[c] - candidates_[one.candidate].place[c]);
    }
    if (apart > nearest) continue;
    if (apart < nearest) sum = count = 0.0;
    nearest = apart;
    sum += one.observation.error * one.observation.error * one.averaged;
    count += 1.0;
  }
  return std::sqrt(sum / count / candidates_[k].steady_share());
}

/// What a run will tell, if it goes as planned.
BudgetPlanner::Told BudgetPlanner::expected(std::size_t k, double averaging) const {
  const double error = noise(k) / std::sqrt(averaging);
  return {k, {state_of(candidates_[k]).value_or(State{}), error}, averaging};
}

Observation BudgetPlanner::observation(const dem::LocalData& run) const {
  State state;
  dem::Estimate friction;
  dem::Estimate inertial;
  if (run.conditions.geometry == "chute") {
    const calibration::FlowPoint point = calibration::flow_point(run);
    friction = calibration::friction_for_fit(point);
    inertial = point.inertial_number;
  } else {
    const calibration::StatePoint point = calibration::box_point(run);
    friction = point.friction;
    inertial = point.inertial_number;
    state.softness = point.softness.value;
    state.bond_number = point.bond_number.value;
  }
  state.inertial_number = inertial.value;
  return {state,
          calibration::effective_friction_error(*table_, state, friction.error, inertial.error)};
}

}  // namespace grainlaw
