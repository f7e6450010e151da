#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

double flowing_grain_steps_per_second(const dem::RunSummary& run) {
  return static_cast<double>(run.steps) * run.flowing_grains / run.wall_seconds;
}

/// Zero stands for a time that nobody took.
std::string time_taken(double seconds) {
  return seconds > 0.0 ? duration(seconds) : "–";
}

Table dem_table(const std::vector<RunComparison>& runs) {
  Table result{.caption = "DEM runs. Grain-steps count the flowing grains."_html,
               .head = {"Run"_html,
                        "Grains, flowing + base"_html,
                        "Steps"_html,
                        "Wall time"_html,
                        "of it start-up"_html,
                        "Million grain-steps per s"_html,
                        "Predicted in"_html},
               .rows = {},
               .text_columns = 1};
  for (const RunComparison& run : runs) {
    const dem::RunSummary& cost = run.data.summary;
    result.rows.push_back({run_label(run),
                           text(count(cost.flowing_grains) + " + " + count(cost.base_grains)),
                           text(count(static_cast<double>(cost.steps))),
                           text(duration(cost.wall_seconds)),
                           text(duration(cost.startup_wall_seconds)),
                           text(significant(1e-6 * flowing_grain_steps_per_second(cost), 3)),
                           text(time_taken(run.predict_seconds))});
  }
  return result;
}

/// Many DEM runs as one stage: a table of all would hide the others; report.json has each.
std::vector<StageCost> stages(const std::vector<StageCost>& costs) {
  constexpr std::string_view dem = "DEM ";
  constexpr std::size_t few = 6;
  std::vector<StageCost> result;
  StageCost runs, longest;
  std::size_t number = 0;
  for (const StageCost& cost : costs) {
    if (!cost.stage.starts_with(dem)) continue;
    ++number;
    runs.wall_seconds += cost.wall_seconds;
    runs.cpu_seconds += cost.cpu_seconds;
    if (cost.wall_seconds > longest.wall_seconds) longest = cost;
  }
  if (number <= few) return costs;
  runs.stage = fmt::format("DEM, {} runs, sum", number);
  longest.stage = "longest of them: " + longest.stage.substr(dem.size());
  result = {runs, longest};
  std::ranges::copy_if(costs, std::back_inserter(result), [&](const StageCost& cost) {
    return !cost.stage.starts_with(dem);
  });
  return result;
}

Table stage_table(const std::vector<StageCost>& costs) {
  Table result{.caption = "Stages."_html,
               .head = {"Stage"_html, "Wall time"_html},
               .rows = {},
               .text_columns = 1};
  const bool cpu =
      std::ranges::any_of(costs, [](const StageCost& cost) { return cost.cpu_seconds > 0; });
  if (cpu) result.head.push_back("CPU time"_html);
  for (const StageCost& cost : stages(costs)) {
    result.rows.push_back({text(cost.stage), text(duration(cost.wall_seconds))});
    if (cpu) result.rows.back().push_back(text(time_taken(cost.cpu_seconds)));
  }
  return result;
}

std::string window_text(const dem::LocalData& data) {
  const double unit = scales(data.conditions).time;
  if (!data.window.steady) return "not steady";
  return fixed(data.window.begin / unit, 1) + " to " + fixed(data.window.end / unit, 1);
}

/// Lowest and middle N_eff over the rows.
std::string sample_text(const dem::LocalData& data) {
  std::vector<double> samples;
  for (const dem::LocalRow& row : data.rows) {
    if (std::isfinite(row.effective_samples)) samples.push_back(row.effective_samples);
  }
  if (samples.empty()) return "–";
  std::sort(samples.begin(), samples.end());
  return significant(samples.front(), 2) + " / " + significant(samples[samples.size() / 2], 2);
}

Table health_table(const Report& report) {
  Table result{
      .caption =
          "Times in √(<i>d</i>/<i>g</i>). <i>N</i><sub>eff</sub>: independent samples of the "
          "velocity, lowest / median over the rows. Energy residual: what the ledger of all "
          "channels leaves unexplained, over the energy dissipated. <i>Z</i>: contacts, each "
          "counted for both grains."_html,
      .head = {"Run"_html,
               "Steady window"_html,
               "<i>N</i><sub>eff</sub>"_html,
               "Time step"_html,
               "Contact time / step"_html,
               "Restitution at this step"_html,
               "Largest overlap [radius]"_html,
               "Share above 0.1 [%]"_html,
               "Energy residual"_html,
               "<i>Z</i>"_html},
      .rows = {},
      .text_columns = 1};
  for (const RunComparison& run : report.runs) {
    const dem::RunSummary& health = run.data.summary;
    result.rows.push_back(
        {run_label(run),
         text(window_text(run.data)),
         text(sample_text(run.data)),
         text(significant(health.time_step / scales(run.data.conditions).time, 3)),
         text(significant(health.contact_time / health.time_step, 3)),
         text(significant(health.restitution, 4)),
         text(significant(health.largest_overlap, 2)),
         text(significant(100.0 * health.deep_overlap_share, 2)),
         text(significant(health.energy_residual, 2)),
         text(significant(health.coordination, 3))});
  }
  return result;
}

Html window_reasons(const Report& report) {
  std::vector<Html> items;
  for (const RunComparison& run : report.runs) {
    if (run.data.window.reason.empty()) continue;
    items.push_back(run_label(run) + typeset(": " + run.data.window.reason));
  }
  return items.empty() ? Html{} : list(items);
}

}  // namespace

Html cost_section(const ReportHead& report, const std::vector<RunComparison>& runs) {
  Html content;
  if (!report.machine.empty()) content += paragraph(text("Machine: " + report.machine + "."));
  if (!report.costs.empty()) content += table(stage_table(report.costs));
  if (!runs.empty()) content += table(dem_table(runs));
  return section("cost", "Run time"_html, content);
}

Html health_section(const Report& report) {
  return section("health",
                 "Health of the DEM runs"_html,
                 table(health_table(report)) + window_reasons(report));
}

}  // namespace grainlaw::report
