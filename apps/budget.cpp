#include "apps/budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "apps/budget_planner.h"
#include "apps/campaign_report.h"
#include "apps/campaign_run.h"
#include "apps/compare_runs.h"
#include "apps/program.h"
#include "calibration/comparison.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Averaging of a candidate that is not to be run again: it arrests, or its runs fail.
constexpr double never = std::numeric_limits<double>::infinity();

/// Parts of a budget that are kept for the predictions and the report at the end.
constexpr double report_part = 0.04;
constexpr double least_report_seconds = 3.0;

double reserve_for_report(double budget) {
  return std::max(report_part * budget, least_report_seconds);
}

/// Relative L2 error of the velocity where the tilt was measured.
double reached(const std::optional<continuum::RheologyTable>& table,
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

class Spending {
 public:
  Spending(const io::Campaign& campaign, const fs::path& directory, const BudgetSettings& settings)
      : campaign_(campaign),
        directory_(directory / "runs"),
        settings_(settings),
        progress_(settings.quiet),
        outcome_(begin(campaign, settings)),
        planner_(campaign,
                 budget_candidates(runs_with_starts(campaign, directory, outcome_.data.warnings)),
                 settings.processes) {
    fs::create_directories(directory_);
    for (BudgetCandidate& one : planner_.candidates()) {
      one.runs = static_cast<int>(
          std::ranges::count(outcome_.data.runs, one.planned.condition, &MeasuredRun::condition));
    }
  }

  BudgetOutcome spend() {
    stop_after(left());
    if (outcome_.data.fitted().size() < BudgetPlanner::fewest_runs) make(first_round());
    while (!interrupted_) {
      learn();
      const std::vector<PlannedSpending> next = planner_.next_round(left());
      if (next.empty()) break;
      make(next);
    }
    constexpr double no_limit = 1e9;
    stop_after(no_limit);
    const report::BudgetReport& report = outcome_.report;
    if (!interrupted_ && !tables_.back()) throw calibration::FitError(report.rounds.back().failure);
    add_reached();
    return std::move(outcome_);
  }

 private:
  static BudgetOutcome begin(const io::Campaign& campaign, const BudgetSettings& settings) {
    BudgetOutcome outcome;
    if (!settings.from.empty()) outcome.data = gather(campaign, settings.from);
    outcome.report.seconds = settings.seconds;
    outcome.report.processes = settings.processes;
    outcome.report.targets = campaign.predict_tilts;
    return outcome;
  }

  double passed() const {
    return std::chrono::duration<double>(steady_clock::now() - start_).count();
  }
  double left() const {
    return settings_.seconds - reserve_for_report(settings_.seconds) - passed();
  }

  std::vector<PlannedSpending> first_round() {
    FirstRound round = planner_.first_round(left());
    if (round.runs.empty()) refuse(round.seconds);
    return std::move(round.runs);
  }

  [[noreturn]] void refuse(double first_seconds) {
    const std::size_t candidates = planner_.candidates().size();
    if (candidates < BudgetPlanner::fewest_runs) {
      throw io::InputError(
          fmt::format("a budget needs at least {} conditions to choose from, and the campaign has "
                      "{}: run it without --budget",
                      BudgetPlanner::fewest_runs,
                      candidates));
    }
    const double runs = first_seconds / BudgetPlanner::first_part + passed();
    const double smallest = std::max(runs / (1.0 - report_part), runs + least_report_seconds);
    throw io::InputError(fmt::format(
        "a budget of {} is too small for these scenes: their {} shortest runs take about {} on {} "
        "processes; give at least {}, or scenes of fewer grains",
        duration_text(settings_.seconds),
        BudgetPlanner::fewest_runs,
        duration_text(first_seconds),
        settings_.processes,
        duration_text(std::ceil(smallest))));
  }

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
      BudgetCandidate& candidate = planner_.candidates()[run.candidate];
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
      take(results[k], planner_.candidates()[runs[k].candidate], slowest);
    }
    if (slowest > 0.0) planner_.set_pace(slowest);
    interrupted_ = stop_requested() && left() > 0.0;
  }

  void take(CampaignRun& run, BudgetCandidate& candidate, double& slowest) {
    cpu_seconds_ += run.cpu_seconds;
    CampaignData& data = outcome_.data;
    if (!run.data && stop_requested()) {
      outcome_.report.notes.push_back(run.name + " was cut off and is not used");
      return;
    }
    if (!run.data) {
      data.failed.push_back(fmt::format("{}: {}", run.name, run.failure));
      outcome_.report.notes.push_back(data.failed.back());
      candidate.least = never;
      return;
    }
    data.kept += run.kept ? 1 : 0;
    data.costs.push_back({"DEM " + run.name, run.data->summary.wall_seconds, run.cpu_seconds});
    const double length = run.data->frames.frames.back().end / candidate.unit;
    slowest =
        std::max(slowest, run.data->summary.wall_seconds / (length * candidate.seconds_per_unit));
    const bool steady = run.data->window.steady;
    if (!steady) {
      outcome_.report.notes.push_back(
          fmt::format("{} is not steady and is not fitted: {}", run.name, run.data->window.reason));
      candidate.warm_up *= 2.0;
      if (run.data->window.arrested_at) candidate.least = never;
    } else if (run.data->conditions.geometry == "chute") {
      candidate.warm_up = run.data->window.begin / candidate.unit;
    }
    const std::string digest = io::digest(data_path(directory_, run.name));
    data.runs.push_back({std::move(*run.data), candidate.planned.condition, steady, digest});
  }

  /// The law as it is now, and what it promises.
  void learn() {
    report::BudgetRound round;
    tables_.emplace_back();
    try {
      const continuum::RheologyTable table = fit_law(campaign_, outcome_.data);
      if (planner_.learn(table, outcome_.data.runs)) tables_.back() = table;
      for (const double tilt : campaign_.predict_tilts) {
        round.surface_velocity.push_back(
            calibration::surface_velocity(table, planner_.target(tilt)));
      }
    } catch (const calibration::FitError& error) {
      round.failure = error.what();
      round.surface_velocity.assign(campaign_.predict_tilts.size(), {nan, nan});
    }
    round.runs = std::exchange(round_, {});
    round.wall_seconds = outcome_.report.spent_seconds = passed();
    round.cpu_seconds = cpu_seconds_;
    outcome_.report.rounds.push_back(std::move(round));
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

  steady_clock::time_point start_ = steady_clock::now();
  const io::Campaign& campaign_;
  fs::path directory_;
  const BudgetSettings& settings_;
  ProgressLine progress_;
  BudgetOutcome outcome_;
  BudgetPlanner planner_;
  double cpu_seconds_ = 0.0;
  bool interrupted_ = false;
  std::vector<std::string> made_;   ///< names of all runs
  std::vector<std::string> round_;  ///< runs since the law was fitted last
  std::vector<std::optional<continuum::RheologyTable>> tables_;  ///< of every round
};

}  // namespace

BudgetOutcome measure_within(const io::Campaign& campaign,
                             const fs::path& directory,
                             const BudgetSettings& settings) {
  return Spending(campaign, directory, settings).spend();
}

}  // namespace grainlaw
