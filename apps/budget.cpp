#include "apps/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numeric>

#include "apps/budget_candidates.h"
#include "apps/campaign_report.h"
#include "apps/campaign_run.h"
#include "apps/compare_runs.h"
#include "apps/program.h"
#include "calibration/box_points.h"
#include "calibration/budget_plan.h"
#include "calibration/comparison.h"
#include "dem/run.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using calibration::Candidate;
using calibration::Observation;
using calibration::State;
using std::chrono::steady_clock;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Part of the budget that the first, spread round may take.
constexpr double first_part = 0.6;
/// Part of the time after it that goes to lack of fit and repeats.
constexpr double exploring_part = 0.3;
/// Part of a run that may be warm-up where the time is enough for a further round.
constexpr double warm_up_part = 0.2;
/// Runs do not go quite as fast as the short one they were timed by.
constexpr double pace_reserve = 1.1;
constexpr std::size_t fewest_runs = 3;  // a law of two coefficients and one run that tests it

/// What is kept for the fit, predictions and report at the end [s].
double reserve_for_report(double budget) {
  return std::max(0.04 * budget, 3.0);
}

/// A run to be made.
struct PlannedSpending {
  std::size_t candidate = 0;
  double averaging = 0.0;  ///< [unit of the candidate]
  std::string why;
};

/// A finished run, as the planner sees it.
struct Told {
  std::size_t candidate = 0;
  Observation observation;
  double averaged = 0.0;  ///< [unit of the candidate]
};

class Spending {
 public:
  Spending(const io::Campaign& campaign, const fs::path& directory, const BudgetSettings& settings)
      : campaign_(campaign),
        directory_(directory / "runs"),
        settings_(settings),
        progress_(settings.quiet) {
    fs::create_directories(directory_);
    if (!settings.from.empty()) outcome_.data = gather(campaign, settings.from);
    outcome_.report.seconds = settings.seconds;
    outcome_.report.processes = settings.processes;
    outcome_.report.targets = campaign.predict_tilts;
    candidates_ = budget_candidates(runs_with_starts(campaign, directory, outcome_.data.warnings));
    for (const MeasuredRun& run : outcome_.data.runs) count(run);
    std::vector<std::vector<double>> places;
    for (const BudgetCandidate& one : candidates_) places.push_back(one.place);
    order_ = calibration::spread_order(places);
    first_runs_ = static_cast<std::size_t>(2 * calibration::varied_coordinates(places) + 1);
  }

  BudgetOutcome spend() {
    stop_after(left());
    if (outcome_.data.fitted().size() < fewest_runs) make(first_round());
    while (!interrupted_) {
      learn();
      const std::vector<PlannedSpending> next = next_round();
      if (next.empty()) break;
      make(next);
    }
    constexpr double no_limit = 1e9;
    stop_after(no_limit);
    if (!interrupted_ && !table_) throw calibration::FitError(outcome_.report.rounds.back().failure);
    add_reached();
    return std::move(outcome_);
  }

 private:
  double passed() const {
    return std::chrono::duration<double>(steady_clock::now() - start_).count();
  }
  double left() const {
    return settings_.seconds - reserve_for_report(settings_.seconds) - passed();
  }

  void count(const MeasuredRun& run) {
    for (BudgetCandidate& one : candidates_) {
      if (one.planned.condition == run.condition) ++one.runs;
    }
  }

  // ---- Which runs

  /// Wall time of these runs, `processes` at a time, in their order.
  double wall_seconds(const std::vector<std::size_t>& chosen) const {
    std::vector<double> busy(static_cast<std::size_t>(settings_.processes), 0.0);
    for (const std::size_t k : chosen) {
      *std::ranges::min_element(busy) += candidates_[k].seconds(candidates_[k].least);
    }
    return pace_ * *std::ranges::max_element(busy);
  }

  /// The candidates that cover the others best; the dearest are left out until the time is enough.
  std::vector<PlannedSpending> first_round() {
    std::vector<std::size_t> pool = order_;
    double enough = 0.0;  // the first part of a budget that suffices for the cheapest choice
    while (pool.size() >= fewest_runs) {
      const std::vector<std::size_t> chosen = spread(pool);
      const double needed = wall_seconds(chosen);
      if (needed <= first_part * left()) return as_short_as_possible(chosen);
      enough = needed;
      pool.erase(std::ranges::max_element(
          pool, {}, [&](std::size_t k) { return candidates_[k].seconds(candidates_[k].least); }));
      if (pool.size() >= fewest_runs) continue;
    }
    refuse(enough);
  }

  [[noreturn]] void refuse(double first_seconds) const {
    if (candidates_.size() < fewest_runs) {
      throw io::InputError(
          fmt::format("a budget needs at least {} conditions to choose from, and the campaign has "
                      "{}: run it without --budget",
                      fewest_runs,
                      candidates_.size()));
    }
    const double smallest = (first_seconds / first_part + passed()) / 0.96 + 3.0;
    throw io::InputError(fmt::format(
        "a budget of {} is too small for these scenes: their {} shortest runs take about {} on {} "
        "processes; give at least {}, or scenes of fewer grains",
        duration_text(settings_.seconds),
        fewest_runs,
        duration_text(first_seconds),
        settings_.processes,
        duration_text(std::ceil(smallest))));
  }

  /// The first of the candidates in the pool, in the order of which they cover it.
  std::vector<std::size_t> spread(const std::vector<std::size_t>& pool) const {
    std::vector<std::vector<double>> places;
    for (const std::size_t k : pool) places.push_back(candidates_[k].place);
    std::vector<std::size_t> chosen;
    for (const std::size_t k : calibration::spread_order(places)) chosen.push_back(pool[k]);
    chosen.resize(std::min(chosen.size(), first_runs_));
    return chosen;
  }

  std::vector<PlannedSpending> as_short_as_possible(std::vector<std::size_t> chosen) {
    // The longest first: the others fill the time beside it.
    std::ranges::sort(chosen, std::greater{}, [&](std::size_t k) {
      return candidates_[k].seconds(candidates_[k].least);
    });
    std::vector<PlannedSpending> runs;
    for (const std::size_t k : chosen) runs.push_back({k, candidates_[k].least, "spread"});
    return runs;
  }

  /// Wall time of each run of the next round [s]: half of what is left, or all of it where warm-ups
  /// would take too much of the half. 0: no run fits.
  double next_run_seconds() const {
    const double all = left() / pace_;
    const auto fits = [](double seconds) {
      return [seconds](const BudgetCandidate& one) { return one.fits(seconds); };
    };
    const auto worthwhile = [&](const BudgetCandidate& one) {
      return one.fits(0.5 * all) &&
             one.warm_up * one.seconds_per_unit <= warm_up_part * 0.5 * all;
    };
    if (std::ranges::all_of(candidates_, worthwhile)) return 0.5 * all;
    return std::ranges::any_of(candidates_, fits(all)) ? all : 0.0;
  }

  std::vector<PlannedSpending> next_round() {
    const double seconds = next_run_seconds();
    std::vector<PlannedSpending> runs;
    if (!(seconds > 0.0) || interrupted_) return runs;
    std::vector<Told> told = told_;
    for (int process = 0; process < settings_.processes; ++process) {
      const bool exploring =
          !table_ || explored_ + seconds <= exploring_part * (later_ + seconds) + 1e-9;
      const std::size_t k = exploring ? least_run(seconds, runs) : wanted(seconds, told);
      const double averaging = candidates_[k].averaging(seconds);
      runs.push_back({k, averaging, exploring ? "lack of fit" : "largest gain"});
      later_ += seconds;
      explored_ += exploring ? seconds : 0.0;
      if (table_) told.push_back(expected(k, averaging));
    }
    return runs;
  }

  /// Of those with the fewest runs the one that is farthest from the others.
  std::size_t least_run(double seconds, const std::vector<PlannedSpending>& chosen) const {
    const auto runs = [&](std::size_t k) {
      const auto now = std::ranges::count(chosen, k, &PlannedSpending::candidate);
      return candidates_[k].fits(seconds) ? static_cast<double>(candidates_[k].runs + now)
                                          : std::numeric_limits<double>::infinity();
    };
    return *std::ranges::min_element(order_, {}, runs);
  }

  std::size_t wanted(double seconds, const std::vector<Told>& told) const {
    std::vector<Candidate> open;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      const std::optional<State> state = state_of(candidates_[k]);
      if (!state || !candidates_[k].fits(seconds)) continue;
      open.push_back({.state = *state,
                      .warm_up = candidates_[k].warm_up * candidates_[k].seconds_per_unit,
                      .noise = noise(k) * std::sqrt(candidates_[k].seconds_per_unit)});
      places.push_back(k);
    }
    if (open.empty()) return least_run(seconds, {});
    const std::vector<std::string> names = calibration::friction_coefficients(*table_);
    std::vector<Observation> known;
    for (const Told& one : told) known.push_back(one.observation);
    return places[calibration::most_wanted(*table_,
                                           names,
                                           open,
                                           target_gradients(names, open),
                                           calibration::information_of(*table_, names, known),
                                           seconds,
                                           seconds * settings_.processes)];
  }

  /// Of the targets that flow; where none does, mu at every candidate.
  std::vector<std::vector<double>> target_gradients(const std::vector<std::string>& names,
                                                    const std::vector<Candidate>& open) const {
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

  continuum::ChuteCase target(double tilt) const {
    return chute_case(dem::conditions(io::scene_at(campaign_, tilt).scene));
  }

  /// Where a candidate lies on the law; a chute that rests lies nowhere.
  std::optional<State> state_of(const BudgetCandidate& candidate) const {
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

  /// Effective error of mu after averaging over one unit, as the nearest candidate with runs shows.
  double noise(std::size_t k) const {
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
    return std::sqrt(sum / count);
  }

  /// What a run will tell, if it goes as planned.
  Told expected(std::size_t k, double averaging) const {
    const double error = noise(k) / std::sqrt(averaging);
    return {k, {state_of(candidates_[k]).value_or(State{}), error}, averaging};
  }

  // ---- The runs

  std::string free_name(const std::string& condition) const {
    const auto taken = [&](const std::string& name) {
      return std::ranges::any_of(outcome_.data.runs,
                                 [&](const MeasuredRun& run) { return run.data.name == name; }) ||
             std::ranges::find(made_, name) != made_.end();
    };
    for (int number = 1;; ++number) {
      std::string name = fmt::format("{}_b{}", condition, number);
      if (!taken(name)) return name;
    }
  }

  void make(const std::vector<PlannedSpending>& runs) {
    std::vector<io::SceneFile> scenes;
    for (const PlannedSpending& run : runs) {
      BudgetCandidate& candidate = candidates_[run.candidate];
      const std::string name = free_name(candidate.planned.condition);
      made_.push_back(name);
      scenes.push_back(budget_scene(candidate, name, run.averaging));
      ++candidate.runs;
      round_.push_back(name + ": " + run.why);
    }
    std::vector<CampaignRun> results =
        run_scenes(scenes, directory_, settings_.processes, progress_);
    double slowest = 0.0;
    for (std::size_t k = 0; k < results.size(); ++k) {
      take(results[k], candidates_[runs[k].candidate], slowest);
    }
    if (slowest > 0.0) pace_ = slowest;
    interrupted_ = stop_requested() && left() > 0.0;
  }

  void take(CampaignRun& run, BudgetCandidate& candidate, double& slowest) {
    cpu_seconds_ += run.cpu_seconds;
    CampaignData& data = outcome_.data;
    if (!run.data) {
      data.failed.push_back(fmt::format("{}: {}", run.name, run.failure));
      outcome_.report.notes.push_back(data.failed.back());
      candidate.least = std::numeric_limits<double>::infinity();  // not again
      return;
    }
    data.kept += run.kept ? 1 : 0;
    data.costs.push_back({"DEM " + run.name, run.data->summary.wall_seconds, run.cpu_seconds});
    const double length = run.data->frames.frames.back().end / candidate.unit;
    slowest = std::max(
        slowest, run.data->summary.wall_seconds / (length * candidate.seconds_per_unit));
    const bool steady = run.data->window.steady;
    if (!steady) {
      outcome_.report.notes.push_back(fmt::format(
          "{} is not steady and is not fitted: {}", run.name, run.data->window.reason));
      candidate.warm_up *= 2.0;
    } else {
      candidate.warm_up = run.data->window.begin / candidate.unit;
    }
    const std::string digest = io::digest(data_path(directory_, run.name));
    data.runs.push_back({std::move(*run.data), candidate.planned.condition, steady, digest});
  }

  // ---- What they told

  void learn() {
    report::BudgetRound round;
    try {
      table_ = fit_law(campaign_, outcome_.data);
      told_ = told_by_runs();
      for (const double tilt : campaign_.predict_tilts) {
        round.surface_velocity.push_back(calibration::surface_velocity(*table_, target(tilt)));
      }
      if (told_.empty()) table_.reset();
    } catch (const calibration::FitError& error) {
      table_.reset();
      round.failure = error.what();
    }
    round.runs = std::exchange(round_, {});
    round.wall_seconds = outcome_.report.spent_seconds = passed();
    round.cpu_seconds = cpu_seconds_;
    outcome_.report.rounds.push_back(std::move(round));
    tables_.push_back(table_);
  }

  std::vector<Told> told_by_runs() const {
    std::vector<Told> result;
    for (const MeasuredRun& run : outcome_.data.runs) {
      if (!run.fitted) continue;
      for (std::size_t k = 0; k < candidates_.size(); ++k) {
        if (candidates_[k].planned.condition != run.condition) continue;
        const double averaged = (run.data.window.end - run.data.window.begin) / candidates_[k].unit;
        const Observation one = observation(run.data);
        if (one.error > 0.0) result.push_back({k, one, averaged});
      }
    }
    return result;
  }

  Observation observation(const dem::LocalData& run) const {
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

  /// Every law of the rounds against the targets that were measured outside the budget.
  void add_reached() {
    const std::vector<dem::LocalData> chutes = outcome_.data.chutes();
    for (std::size_t k = 0; k < tables_.size(); ++k) {
      for (const double tilt : campaign_.predict_tilts) {
        outcome_.report.rounds[k].reached.push_back(reached(tables_[k], tilt, chutes));
      }
    }
  }

  static double reached(const std::optional<continuum::RheologyTable>& table,
                        double tilt,
                        const std::vector<dem::LocalData>& chutes) {
    const auto run = std::ranges::find_if(chutes, [&](const dem::LocalData& chute) {
      return chute.window.steady && std::abs(chute.conditions.inclination - tilt) < 1e-9;
    });
    if (!table || run == chutes.end()) return nan;
    const auto steady = continuum::steady_chute(*table, chute_case(run->conditions));
    if (!continuum::flows(steady.answer.outcome) || steady.profile.rows.empty()) return nan;
    return calibration::profile_error(*run, steady.profile).velocity.value;
  }

  const io::Campaign& campaign_;
  fs::path directory_;
  const BudgetSettings& settings_;
  ProgressLine progress_;
  steady_clock::time_point start_ = steady_clock::now();
  BudgetOutcome outcome_;
  std::vector<BudgetCandidate> candidates_;
  std::vector<std::size_t> order_;  ///< in which the candidates cover their space
  std::size_t first_runs_ = fewest_runs;
  double pace_ = pace_reserve;  ///< wall time over the one that was expected
  double cpu_seconds_ = 0.0;
  double later_ = 0.0;     ///< seconds of runs after the first round
  double explored_ = 0.0;  ///< of them, for lack of fit and repeats
  bool interrupted_ = false;
  std::vector<std::string> made_;
  std::vector<std::string> round_;
  std::vector<Told> told_;
  std::optional<continuum::RheologyTable> table_;
  std::vector<std::optional<continuum::RheologyTable>> tables_;  ///< of every round
};

}  // namespace

BudgetOutcome measure_within(const io::Campaign& campaign,
                             const fs::path& directory,
                             const BudgetSettings& settings) {
  return Spending(campaign, directory, settings).spend();
}

}  // namespace grainlaw
