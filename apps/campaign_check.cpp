#include "apps/campaign_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/budget_planner.h"
#include "apps/campaign_data.h"
#include "apps/imported_runs.h"
#include "apps/program.h"
#include "apps/progress.h"
#include "apps/scene_run.h"

namespace grainlaw {
namespace {

using Texts = std::vector<std::string>;

/// Names of the conditions that no run was given for, in the order of the plan.
Texts missing_conditions(const io::Campaign& campaign, const CampaignData& data) {
  Texts missing;
  for (const io::PlannedRun& run : io::planned_runs(campaign)) {
    if (std::ranges::find(data.runs, run.condition, &MeasuredRun::condition) != data.runs.end())
      continue;
    if (std::ranges::find(missing, run.condition) == missing.end())
      missing.push_back(run.condition);
  }
  return missing;
}

void add_given(Summary& summary, const CampaignData& data) {
  Texts fitted, others, left_out;
  for (const MeasuredRun& run : data.runs) {
    if (run.fitted)
      fitted.push_back(run.data.name);
    else if (run.data.window.steady)
      others.push_back(run.data.name);
    else
      left_out.push_back(run.data.name + ": " + run.data.window.reason);
  }
  summary.add("runs", "runs given", static_cast<long>(data.runs.size()));
  summary.add("fitted", "  fitted", fitted);
  summary.add("compared", "  held against it", others);
  summary.add("left_out", "  left out, not steady", left_out);
}

void add_checks_of_imports(Summary& summary, const CampaignData& data) {
  for (const io::RunRecord& record : data.imported) add_checks(summary, record);
}

void add_first_round(Summary& summary, BudgetPlanner& planner, double seconds, int processes) {
  const std::size_t candidates = planner.candidates().size();
  if (candidates < BudgetPlanner::fewest_runs) {
    throw NoAnswer(
        fmt::format("a budget needs at least {} conditions to choose from, and the campaign has {}",
                    BudgetPlanner::fewest_runs,
                    candidates));
  }
  const FirstRound first = planner.first_round(seconds);
  if (first.runs.empty()) {
    throw NoAnswer(
        fmt::format("a budget of {} is too small: the {} shortest runs take about {} on {} "
                    "processes, and they may take {:.0f} % of it",
                    duration_text(seconds),
                    BudgetPlanner::fewest_runs,
                    duration_text(first.seconds),
                    processes,
                    100.0 * BudgetPlanner::first_part));
  }
  Texts runs;
  for (const PlannedSpending& run : first.runs)
    runs.push_back(planner.candidates()[run.candidate].planned.condition);
  summary.add("first_runs", "first runs", runs);
  summary.add("first_seconds", "  which take about", duration_text(first.seconds));
}

}  // namespace

void check_runs(const io::Campaign& campaign, const CommonOptions& options) {
  std::string text;
  RunTime total;
  int runs = 0;
  for (const io::PlannedRun& run : io::planned_runs(campaign)) {
    const RunTime time = run_time(run.file.scene);
    total.least += time.least;
    total.most += time.most;
    ++runs;
    const Summary summary = check_scene(run.file, time);
    if (!text.empty()) text += options.json ? ",\n" : "\n";
    text += options.json ? summary.json() : summary.text();
  }
  if (!options.json && runs > 1) {
    text += fmt::format("\nall {} runs, one after the other: {} to {}; {} at a time\n",
                        runs,
                        duration_text(total.least),
                        duration_text(total.most),
                        options.threads);
  }
  fmt::print("{}", options.json ? "[\n" + text + "]\n" : text);
}

void check_given(const io::Campaign& campaign,
                 const std::vector<std::string>& from,
                 const CommonOptions& options) {
  const CampaignData data = gather(campaign, from);
  Summary summary;
  add_given(summary, data);
  summary.add("missing", "  no run of", missing_conditions(campaign, data));
  summary.add("would", "would", std::string("fit and report these, and run nothing"));
  add_checks_of_imports(summary, data);
  print(summary, options);
}

void check_budget(const io::Campaign& campaign,
                  const std::vector<std::string>& from,
                  double seconds,
                  const CommonOptions& options) {
  CampaignData data;
  if (!from.empty()) data = gather(campaign, from);
  BudgetPlanner planner(campaign, budget_candidates(io::planned_runs(campaign)), options.threads);
  Summary summary;
  summary.add("budget", "budget", duration_text(seconds));
  Texts candidates, targets;
  for (const BudgetCandidate& one : planner.candidates())
    candidates.push_back(one.planned.condition);
  for (const double tilt : campaign.predict_tilts)
    targets.push_back(fmt::format("{:.4g} degrees", io::degrees(tilt)));
  summary.add("candidates", "to choose from", candidates);
  summary.add("targets", "for the surface velocity at", targets);
  if (!from.empty()) add_given(summary, data);
  if (data.fitted().size() < BudgetPlanner::fewest_runs)
    add_first_round(summary, planner, seconds, options.threads);
  add_checks_of_imports(summary, data);
  print(summary, options);
}

}  // namespace grainlaw
