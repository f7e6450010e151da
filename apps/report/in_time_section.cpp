#include <fmt/format.h>

#include <algorithm>

#include "apps/report/numbers.h"
#include "apps/report/sections.h"

namespace grainlaw::report {
namespace {

using calibration::Stretch;

std::string time_text(const RunComparison& run, double time) {
  return fmt::format("{:.4g}", time / scales(run.data.conditions).time);
}

std::string time_text(const RunComparison& run, const dem::Estimate& time) {
  return with_error(scaled(time, 1.0 / scales(run.data.conditions).time));
}

/// The moment at which the velocity profile is furthest off.
const calibration::Moment& worst_moment(const Stretch& stretch) {
  return *std::ranges::max_element(stretch.moments, {}, &calibration::Moment::velocity_error);
}

/// "29 ± 0.6 | 31": times to steady, or of a stop.
std::vector<Html> time_cells(const RunComparison& run, const Stretch& stretch) {
  std::vector<Html> cells(4, text("–"));
  if (stretch.to_steady) {
    cells[0] = text(time_text(run, stretch.to_steady->measured));
    cells[1] = text(time_text(run, stretch.to_steady->predicted));
  }
  if (!stretch.stop) return cells;
  cells[2] = text(stretch.stop->measured ? time_text(run, *stretch.stop->measured) : "flows on");
  cells[3] = text(stretch.stop->predicted ? time_text(run, *stretch.stop->predicted) : "flows on");
  return cells;
}

Table in_time_table(const Report& report) {
  Table result{.caption = {},
               .head = {"Run"_html,
                        "What"_html,
                        "Error of <i>u</i>(<i>z</i>, <i>t</i>), rms [%]"_html,
                        "largest [%]"_html,
                        "at <i>t</i>"_html,
                        "To steady, DEM"_html,
                        "continuum"_html,
                        "Stopped, DEM"_html,
                        "continuum"_html},
               .rows = {},
               .text_columns = 2};
  for (const RunComparison& run : report.runs) {
    for (const Stretch& stretch : run.in_time) {
      if (stretch.moments.empty()) continue;
      const calibration::Moment& worst = worst_moment(stretch);
      result.rows.push_back({code(run.data.name),
                             text(stretch_title(stretch)),
                             text(significant(100.0 * stretch.error, 2)),
                             text(significant(100.0 * worst.velocity_error, 2)),
                             text(time_text(run, worst.time - stretch.begin))});
      for (Html& cell : time_cells(run, stretch)) result.rows.back().push_back(std::move(cell));
    }
  }
  return result;
}

Table solver_table(const Report& report) {
  Table result{
      .caption = "The solver behind it."_html,
      .head = {"Run"_html, "CVODE ends"_html, "Steady − CVODE [relative]"_html, "CVODE steps"_html},
      .rows = {},
      .text_columns = 2};
  for (const RunComparison& run : report.runs) {
    if (!run.transient || run.in_time.empty()) continue;
    const bool flows = run.steady_against_transient > 0.0;
    result.rows.push_back({run_label(run),
                           text(continuum::name(run.transient->answer.outcome)),
                           text(flows ? significant(run.steady_against_transient, 2) : "–"),
                           text(count(static_cast<double>(run.transient->statistics.steps)))});
  }
  return result;
}

}  // namespace

std::string stretch_title(const Stretch& stretch) {
  const std::string tilt = degrees(stretch.inclination);
  const std::string change =
      stretch.inclination_before
          ? fmt::format("{} → {}", degrees(*stretch.inclination_before), tilt)
          : tilt;
  return fmt::format("{}, {}", calibration::name(stretch.change), change);
}

Html in_time_section(const Report& report,
                     const std::vector<FigureGroup>& groups,
                     const Pictures& pictures) {
  const Table numbers = in_time_table(report);
  Html content =
      paragraph(
          "Nobody fitted this: the law knows steady flow only. The continuum begins at rest, at "
          "the density of the law, and is tilted when the run was. Errors are <i>L</i><sub>2"
          "</sub> over the faster of the steady profiles before and after the change, up to the "
          "later of two stops. DEM values are averages over one frame each."_html) +
      paragraph(
          "Times in √(<i>d</i>/<i>g</i>), from the change on. To steady: until the mean velocity "
          "first comes within 5 % of its change of its last value, or within three standard "
          "deviations of the DEM frames where these are more; both sides at the frames. Times "
          "are known to one frame: ± is that of a time anywhere in it, fluctuations of the flow "
          "not included."_html) +
      table(numbers) + table(solver_table(report));
  for (const FigureGroup& group : groups) content += show(group, pictures);
  return section("in-time", "In time: nobody fitted this"_html, content);
}

}  // namespace grainlaw::report
