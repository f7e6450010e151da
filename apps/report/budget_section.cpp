#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figure.h"
#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* data_file = "budget.csv";
constexpr std::size_t most_rounds = 20;  // to read at a glance

/// Standard error over value; NaN where a target has no prediction with an error.
double relative_error(const BudgetRound& round, std::size_t target) {
  if (target >= round.surface_velocity.size()) return nan;
  const dem::Estimate& velocity = round.surface_velocity[target];
  const double ratio = velocity.error / velocity.value;
  return ratio > 0.0 ? ratio : nan;
}

double reached_error(const BudgetRound& round, std::size_t target) {
  const double error = target < round.reached.size() ? round.reached[target] : nan;
  return error > 0.0 ? error : nan;
}

std::string in_percent(double ratio) {
  return significant(100.0 * ratio, 2);
}

std::vector<Html> head(const BudgetReport& budget) {
  std::vector<Html> result{"Runs"_html, "After"_html, "CPU of DEM"_html};
  for (const double tilt : budget.targets) {
    result.push_back(text(degrees(tilt) + ", predicted %"));
    result.push_back(text(degrees(tilt) + ", reached %"));
  }
  return result;
}

/// "3 runs of I0.14_p0.0001_Bo0: largest gain" for those of one condition and reason.
std::vector<Html> run_lines(const std::vector<BudgetRun>& runs) {
  std::vector<Html> lines;
  for (auto run = runs.begin(); run != runs.end(); ++run) {
    const auto alike = [&](const BudgetRun& other) {
      return other.condition == run->condition && other.why == run->why;
    };
    if (std::any_of(runs.begin(), run, alike)) continue;
    const auto seeds = std::count_if(run, runs.end(), alike);
    lines.push_back(text(seeds == 1
                             ? fmt::format("{}: {}", run->name, run->why)
                             : fmt::format("{} runs of {}: {}", seeds, run->condition, run->why)));
  }
  return lines;
}

std::vector<Html> row(const BudgetReport& budget, const BudgetRound& round) {
  std::vector<Html> lines = run_lines(round.runs);
  if (!round.failure.empty()) lines.push_back(text("no law yet: " + round.failure));
  std::vector<Html> result{join(lines, "<br/>"_html),
                           text(duration(round.wall_seconds)),
                           text(duration(round.cpu_seconds))};
  for (std::size_t k = 0; k < budget.targets.size(); ++k) {
    result.push_back(text(in_percent(relative_error(round, k))));
    result.push_back(text(in_percent(reached_error(round, k))));
  }
  return result;
}

Csv budget_csv(const BudgetReport& budget) {
  Csv csv{.columns = {"wall time [s]"}, .rows = {}};
  for (std::size_t k = 0; k < budget.targets.size(); ++k) {
    csv.columns.push_back(fmt::format("predicted {}", k + 1));
    csv.columns.push_back(fmt::format("reached {}", k + 1));
  }
  for (const BudgetRound& round : budget.rounds) {
    std::vector<double> values{round.wall_seconds};
    for (std::size_t k = 0; k < budget.targets.size(); ++k) {
      values.push_back(relative_error(round, k));
      values.push_back(reached_error(round, k));
    }
    csv.rows.push_back(values);
  }
  return csv;
}

bool has_number(const Csv& csv, std::size_t column) {
  return std::ranges::any_of(csv.rows,
                             [&](const auto& values) { return std::isfinite(values[column]); });
}

std::string script(const BudgetReport& budget, const Csv& csv) {
  std::string parts;
  double lowest = nan;
  double highest = nan;
  for (std::size_t column = 1; column < csv.columns.size(); ++column) {
    if (!has_number(csv, column)) continue;
    for (const auto& values : csv.rows) {
      lowest = std::fmin(lowest, values[column]);
      highest = std::fmax(highest, values[column]);
    }
    const bool predicted = column % 2 == 1;
    const std::size_t target = (column - 1) / 2;
    parts += fmt::format("{}'{}' using 1:{} with linespoints lw 1.3 dt {} {} title '{} {}'",
                         parts.empty() ? "plot " : ", \\\n     ",
                         data_file,
                         column + 1,
                         predicted ? "(6,4)" : "1",
                         point_style(target),
                         degrees(budget.targets[target]),
                         predicted ? "predicted" : "reached");
  }
  return plot_head("budget") + "set tmargin at screen 0.80\nset logscale xy\n" +
         log_axis('x', 0.8 * csv.rows.front()[0], 1.25 * csv.rows.back()[0]) +
         log_axis('y', 0.6 * lowest, 1.6 * highest) +
         "set xlabel 'wall time [s]'\nset ylabel 'velocity error, relative'\n" + parts + "\n";
}

}  // namespace

FigureGroup budget_figures(const BudgetReport& budget) {
  FigureGroup group;
  const Csv csv = budget_csv(budget);
  bool any = false;
  for (std::size_t column = 1; column < csv.columns.size(); ++column) {
    any = any || has_number(csv, column);
  }
  if (!any) return group;
  group.data[data_file] = csv;
  group.figures.push_back(
      {.name = "budget",
       .script = script(budget, csv),
       .label = "Errors of the targets against the wall time of the calibration",
       .caption = "Standard error of the predicted surface velocity (dashed) and relative "
                  "<i>L</i><sub>2</sub> error of the velocity where the target was measured "
                  "(solid), as the budget is spent"_html});
  return group;
}

Html budget_section(const BudgetReport& budget,
                    const FigureGroup& group,
                    const Pictures& pictures) {
  Table rounds{.caption =
                   "Predicted: standard error of the surface velocity by the covariance of "
                   "the law at that time, and by a curvature it may have left out. Reached: "
                   "relative L2 error of the velocity "
                   "against a chute measured outside the budget."_html,
               .head = head(budget),
               .rows = {},
               .text_columns = 1};
  for (const BudgetRound& round : budget.rounds) rounds.rows.push_back(row(budget, round));
  Html content = paragraph(text(fmt::format("{} of {} spent, {} runs at a time.",
                                            duration(budget.spent_seconds),
                                            duration(budget.seconds),
                                            budget.processes))) +
                 folded(budget.rounds.size(), most_rounds, "rounds", table(rounds)) +
                 show(group, pictures);
  std::vector<Html> notes;
  for (const std::string& note : budget.notes) notes.push_back(typeset(note));
  if (!notes.empty()) content += long_list(notes, "remarks on runs");
  return section("budget", "Budget"_html, content);
}

}  // namespace grainlaw::report
