#include "apps/report/budget_json.h"

#include "apps/report/json_parts.h"

namespace grainlaw::report {
namespace {

json run_json(const BudgetRun& run) {
  return run.name + ": " + run.why;
}

json round_json(const BudgetRound& round) {
  return {{"runs", list_json(round.runs, run_json)},
          {"wall_seconds", round.wall_seconds},
          {"cpu_seconds", round.cpu_seconds},
          {"surface_velocity", list_json(round.surface_velocity, estimate_json)},
          {"reached", round.reached},
          {"failure", round.failure}};
}

}  // namespace

json budget_json(const BudgetReport& budget) {
  return {{"seconds", budget.seconds},
          {"spent_seconds", budget.spent_seconds},
          {"processes", budget.processes},
          {"targets", budget.targets},
          {"rounds", list_json(budget.rounds, round_json)},
          {"notes", budget.notes}};
}

}  // namespace grainlaw::report
