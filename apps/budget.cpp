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
#include "apps/exit_code.h"
#include "apps/measured_so_far.h"
#include "apps/program.h"
#include "calibration/comparison.h"

namespace grainlaw {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Averaging of a candidate that is not to be run again: it arrests, or its runs fail.
constexpr double never = std::numeric_limits<double>::infinity();

/// Kept of a budget for its end until a first report has shown what that takes.
constexpr double report_part = 0.04;
constexpr double least_report_seconds = 4.0;

/// The last report over the first: it shows more runs, and other programs may want the machine.
constexpr double later_report = 3.0;
/// For runs to see that they have to stop, and to write what they have [s].
constexpr double stopping_seconds = 1.0;

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

/// A law to start chutes with, from runs as they were at their ends: no law to predict with, as
/// some were still on their way. Absent where not even that can be fitted.
std::optional<continuum::RheologyTable> rough_law(const io::Campaign& campaign, CampaignData data) {
  constexpr double at_the_end = 1.0 / 3.0;  // of a run
  for (MeasuredRun& run : data.runs) {
    if (run.fitted || run.data.window.arrested_at) continue;
    const double end = run.data.frames.frames.back().end;
    run.data.window = {.steady = true, .begin = (1.0 - at_the_end) * end, .end = end};
    run.data.rows = dem::average(run.data.frames, run.data.conditions, run.data.window);
    run.fitted = true;
  }
  try {
    return fit_law(campaign, data);
  } catch (const calibration::FitError&) {
    return std::nullopt;
  }
}

class Spending {
 public:
  Spending(const io::Campaign& campaign, const fs::path& directory, const BudgetSettings& settings)
      : campaign_(campaign),
        directory_(directory / "runs"),
        starts_(directory / "starts"),
        settings_(settings),
        progress_(settings.quiet),
        kept_(std::max(report_part * settings.seconds, least_report_seconds)),
        outcome_(begin(campaign, settings)),
        planner_(campaign,
                 budget_candidates(runs_with_starts(campaign, directory, outcome_.data.warnings)),
                 settings.processes) {
    fs::create_directories(directory_);
    given_ = outcome_.data.runs.size();
    for (BudgetCandidate& one : planner_.candidates()) {
      one.runs = static_cast<int>(
          std::ranges::count(outcome_.data.runs, one.planned.condition, &MeasuredRun::condition));
    }
  }

  BudgetOutcome spend() {
    if (outcome_.data.fitted().size() < BudgetPlanner::fewest_runs) make(first_round());
    while (!interrupted_) {
      learn();
      write_first_report();
      const std::vector<PlannedSpending> next = planner_.next_round(left());
      if (next.empty()) break;
      make(next);
    }
    constexpr double no_limit = 1e9;
    stop_after(no_limit);
    const report::BudgetReport& report = outcome_.report;
    if (!interrupted_ && !tables_.back()) {
      throw calibration::FitError("the runs of this budget give no law, a larger one may: " +
                                  report.rounds.back().failure);
    }
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
  double left() const { return settings_.seconds - kept_ - passed(); }

  std::vector<PlannedSpending> first_round() {
    FirstRound round = planner_.first_round(left());
    if (round.runs.empty()) refuse(round.seconds);
    return std::move(round.runs);
  }

  [[noreturn]] void refuse(double first_seconds) {
    const std::size_t candidates = planner_.candidates().size();
    if (candidates < BudgetPlanner::fewest_runs) {
      throw NoAnswer(
          fmt::format("a budget needs at least {} conditions to choose from, and the campaign has "
                      "{}: run it without --budget",
                      BudgetPlanner::fewest_runs,
                      candidates));
    }
    const double runs = first_seconds / BudgetPlanner::first_part + passed();
    const double smallest = std::max(runs / (1.0 - report_part), runs + least_report_seconds);
    throw NoAnswer(fmt::format(
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
    std::vector<double> warm_ups;
    for (const PlannedSpending& run : runs) {
      const BudgetCandidate& candidate = planner_.candidates()[run.candidate];
      const std::string name = free_name(candidate.planned.condition);
      // A seed of its own for every run: bases and packings of the tilts are independent.
      const std::size_t seeds_on = given_ + made_.size();
      made_.push_back(name);
      warm_ups.push_back(candidate.warm_up);
      scenes.push_back(started(budget_scene(candidate, name, run.averaging, seeds_on)));
      round_.push_back({name, candidate.planned.condition, run.why});
    }
    stop_after(left());
    std::vector<CampaignRun> results =
        run_scenes(scenes, directory_, settings_.processes, progress_);
    interrupted_ = stop_requested() && left() > 0.0;
    double slowest = 0.0;
    for (std::size_t k = 0; k < results.size(); ++k) {
      BudgetCandidate& candidate = planner_.candidates()[runs[k].candidate];
      if (!interrupted_) salvage(results[k], scenes[k], candidate);
      take(results[k], candidate, warm_ups[k], slowest);
    }
    if (slowest > 0.0) planner_.set_pace(slowest);
  }

  /// A chute starts with the profile of the law, where there is one already.
  io::SceneFile started(const io::SceneFile& file) const {
    const bool chute = std::holds_alternative<dem::Chute>(file.scene.geometry);
    if (!chute || !start_law_) return file;
    fs::create_directories(starts_);
    return started_from(file, *start_law_, starts_).value_or(file);
  }

  void salvage(CampaignRun& run, const io::SceneFile& file, const BudgetCandidate& candidate) {
    const bool stopped = !run.data && stop_requested();
    const bool unsteady = run.data && !run.data->window.steady && !run.data->window.arrested_at;
    if (!stopped && !unsteady) return;
    const double usable = candidate.usable * candidate.unit;
    if (auto data = measured_so_far(file, usable, data_path(directory_, run.name))) {
      run.data = std::move(data);
      outcome_.report.notes.push_back(
          fmt::format("{} ended early: {}", run.name, run.data->window.reason));
    }
  }

  void take(CampaignRun& run, BudgetCandidate& candidate, double warm_up, double& slowest) {
    cpu_seconds_ += run.cpu_seconds;
    CampaignData& data = outcome_.data;
    if (!run.data && stop_requested()) {
      outcome_.report.notes.push_back(run.name + " was cut off and is not used");
      return;
    }
    if (!run.data) {
      data.failed.push_back(fmt::format("{}: {}", run.name, run.failure));
      outcome_.report.notes.push_back(data.failed.back());
      if (++candidate.failures > 1) candidate.least = never;  // another seed may do
      return;
    }
    data.kept += run.kept ? 1 : 0;
    data.costs.push_back({"DEM " + run.name, run.data->summary.wall_seconds, run.cpu_seconds});
    const double length = run.data->frames.frames.back().end / candidate.unit;
    slowest =
        std::max(slowest, run.data->summary.wall_seconds / (length * candidate.seconds_per_unit));
    const bool steady = run.data->window.steady;
    const bool chute = run.data->conditions.geometry == "chute";
    if (!steady) {
      outcome_.report.notes.push_back(
          fmt::format("{} is not steady and is not fitted: {}", run.name, run.data->window.reason));
      // After the first round chutes start nearer to their flow.
      candidate.count_unsteady(warm_up, !chute || start_law_);
      if (run.data->window.arrested_at) candidate.least = never;
    } else if (chute) {
      candidate.warm_up = std::min(candidate.warm_up, run.data->window.begin / candidate.unit);
    }
    candidate.runs += steady ? 1 : 0;
    const std::string digest = io::digest(data_path(directory_, run.name));
    data.runs.push_back({std::move(*run.data), candidate.planned.condition, steady, digest});
  }

  /// Without those that were given: targets must not tell anything.
  CampaignData own_runs() const {
    CampaignData own = outcome_.data;
    std::erase_if(own.runs, [&](const MeasuredRun& run) {
      return std::ranges::find(made_, run.data.name) == made_.end();
    });
    return own;
  }

  /// The law as it is now, and what it promises.
  void learn() {
    report::BudgetRound round;
    tables_.emplace_back();
    try {
      const continuum::RheologyTable table = fit_law(campaign_, outcome_.data);
      const bool planned = planner_.learn(table, outcome_.data.runs);
      start_law_ = table;
      if (planned) tables_.back() = table;
      for (const double tilt : campaign_.predict_tilts) {
        round.surface_velocity.push_back(
            planned ? planner_.surface_velocity(tilt)
                    : calibration::surface_velocity(table, planner_.target(tilt)));
      }
    } catch (const calibration::FitError& error) {
      round.failure = error.what();
      round.surface_velocity.assign(campaign_.predict_tilts.size(), {nan, nan});
      start_law_ = rough_law(campaign_, own_runs());
    }
    round.runs = std::exchange(round_, {});
    round.wall_seconds = outcome_.report.spent_seconds = passed();
    round.cpu_seconds = cpu_seconds_;
    outcome_.report.rounds.push_back(std::move(round));
  }

  /// A report is there from now on; what it takes is kept for the last one.
  void write_first_report() {
    if (wrote_report_ || !tables_.back() || !settings_.write_report) return;
    const double before = passed();
    settings_.write_report(outcome_.data, outcome_.report);
    kept_ = later_report * (passed() - before) + stopping_seconds;
    wrote_report_ = true;
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
  fs::path starts_;
  const BudgetSettings& settings_;
  ProgressLine progress_;
  double kept_;            ///< for the end [s]
  std::size_t given_ = 0;  ///< finished runs that cost nothing
  bool wrote_report_ = false;
  BudgetOutcome outcome_;
  BudgetPlanner planner_;
  double cpu_seconds_ = 0.0;
  bool interrupted_ = false;
  std::vector<std::string> made_;                                ///< names of all runs
  std::vector<report::BudgetRun> round_;                         ///< since the law was fitted last
  std::vector<std::optional<continuum::RheologyTable>> tables_;  ///< of every round
  std::optional<continuum::RheologyTable> start_law_;            ///< of the latest runs
};

}  // namespace

BudgetOutcome measure_within(const io::Campaign& campaign,
                             const fs::path& directory,
                             const BudgetSettings& settings) {
  return Spending(campaign, directory, settings).spend();
}

}  // namespace grainlaw
