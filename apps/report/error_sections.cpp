#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/report/numbers.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::ProfileError;
using calibration::SampleKind;

Html kind_heading(SampleKind kind) {
  switch (kind) {
    case SampleKind::in_sample:
      return "In sample: the law was fitted to these runs"_html;
    case SampleKind::interpolation:
      return "Predicted, interpolation: tilts between the fitted ones"_html;
    case SampleKind::extrapolation:
      return "Predicted, extrapolation: tilts outside the fitted ones"_html;
    case SampleKind::leave_one_out:
      return "Left out: the law was refitted without this tilt"_html;
    case SampleKind::cross_geometry:
      return "Predicted, cross geometry: the law was fitted to another flow"_html;
    default:
      return "Predicted by an independent table: none of these runs was fitted"_html;
  }
}

Html naive_cell(const RunComparison& run) {
  if (!run.naive_error) return text("–");
  return text(percent_value(run.naive_error->velocity));
}

Html condition_cell(const RunComparison& run) {
  const double number = run.steady.answer.condition_number;
  return text(number > 0.0 ? significant(number, 2) : "–");
}

std::vector<Html> error_row(const RunComparison& run) {
  const ProfileError& error = *run.error;
  return {run_label(run),
          text(percent_value(error.velocity)),
          naive_cell(run),
          text(percent_value(error.velocity_maximum)),
          text(percent_value(error.volume_fraction)),
          text(percent_value(error.friction)),
          text(percent_value(error.surface_velocity)),
          text(percent_value(error.flux)),
          text(significant(error.in_standard_errors, 2)),
          condition_cell(run)};
}

std::vector<Html> missing_row(const RunComparison& run) {
  std::vector<Html> row(10, text("–"));
  row.front() = run_label(run);
  return row;
}

Table error_table(const Report& report) {
  Table result{.caption =
                   "Predicted against measured steady profiles, differences in % ± standard "
                   "error of the DEM profile."_html,
               .head = {"Run"_html,
                        "<i>u</i>, <i>L</i><sub>2</sub>"_html,
                        "naive <i>u</i>, <i>L</i><sub>2</sub>"_html,
                        "<i>u</i>, largest"_html,
                        "<i>φ</i>, <i>L</i><sub>2</sub>"_html,
                        "<i>μ</i>, <i>L</i><sub>2</sub>"_html,
                        "surface <i>u</i>"_html,
                        "flux"_html,
                        "rms / s.e."_html,
                        "d ln <i>I</i>/d ln <i>μ</i>"_html},
               .rows = {},
               .text_columns = 1};
  for (const SampleKind kind : all_kinds) {
    const auto runs = runs_of(report, kind);
    if (!runs.empty()) result.rows.push_back({kind_heading(kind)});
    for (const RunComparison* run : runs) {
      result.rows.push_back(run->error ? error_row(*run) : missing_row(*run));
    }
  }
  return result;
}

Html naive_sentence(const Report& report) {
  std::vector<Html> parts;
  for (const RunComparison& run : report.runs) {
    if (!run.naive_source.empty())
      parts.push_back(run_label(run) + " from "_html + code(run.naive_source));
  }
  if (parts.empty()) return {};
  return paragraph(
      "Naive guess: the measured profile of the nearest fitted tilt, height scaled by "
      "mass, velocity by Bagnold with the same <i>a</i> ("_html +
      join(parts, "; "_html) + ")."_html);
}

Html missing_sentences(const Report& report) {
  std::vector<Html> items;
  for (const RunComparison& run : report.runs) {
    if (run.error) continue;
    items.push_back(
        run_label(run) +
        typeset(fmt::format(": no profiles to compare. Continuum: {}. DEM: {}",
                            continuum::name(run.steady.answer.outcome),
                            run.data.window.steady ? "steady" : run.data.window.reason)));
  }
  return items.empty() ? Html{} : list(items);
}

Html all_groups(const std::vector<FigureGroup>& groups, const Pictures& pictures) {
  Html result;
  for (const FigureGroup& group : groups) result += show(group, pictures);
  return result;
}

Table time_table(const Report& report) {
  Table result{.caption =
                   "Error when only part of the averaging time is used. The law is held against "
                   "the fit to everything, which contains that part; profile errors are "
                   "relative <i>L</i><sub>2</sub> of <i>u</i>."_html,
               .head = {"Averaging time [√(<i>d</i>/<i>g</i>)]"_html,
                        "DEM wall time"_html,
                        "<i>μ</i><sub>0</sub>"_html,
                        "<i>I</i> off the full fit [%]"_html,
                        "Claimed s.e. of <i>I</i> [%]"_html},
               .rows = {},
               .text_columns = 0};
  for (const RunComparison& run : report.runs)
    result.head.push_back(code(run.data.name) + " [%]"_html);
  const double time = report.runs.empty() ? 1.0 : scales(report.runs.front().data.conditions).time;
  for (const TimeErrorPoint& point : report.error_against_time) {
    std::vector<Html> row = {text(significant(point.averaging_time / time, 3)),
                             text(duration(point.dem_wall_seconds))};
    if (!point.failure.empty()) {
      row.resize(result.head.size(), text("–"));
      result.rows.push_back(std::move(row));
      continue;
    }
    row.push_back(text(with_error(point.mu0)));
    row.push_back(text(significant(100.0 * point.law_error, 2)));
    row.push_back(text(significant(100.0 * point.law_standard_error, 2)));
    for (std::size_t k = 0; k < report.runs.size(); ++k) {
      const auto at = [k](const std::vector<double>& v) { return k < v.size() ? v[k] : NAN; };
      row.push_back(text(percent_value(
          {.value = at(point.profile_error), .error = at(point.profile_standard_error)})));
    }
    result.rows.push_back(std::move(row));
  }
  return result;
}

Html time_failures(const Report& report) {
  std::vector<Html> items;
  for (const TimeErrorPoint& point : report.error_against_time) {
    if (point.failure.empty()) continue;
    items.push_back(typeset(fmt::format("No fit from an averaging time of {}: {}",
                                        significant(point.averaging_time, 3),
                                        point.failure)));
  }
  return items.empty() ? Html{} : list(items);
}

}  // namespace

Html prediction_section(const Report& report,
                        const std::vector<FigureGroup>& groups,
                        const Pictures& pictures) {
  Html content = table(error_table(report)) + naive_sentence(report) + missing_sentences(report);
  return section("predictions",
                 "Steady profiles: DEM against continuum"_html,
                 content + all_groups(groups, pictures));
}

Html time_section(const Report& report, const FigureGroup& group, const Pictures& pictures) {
  const Html content =
      report.error_against_time.empty()
          ? paragraph("Not computed: it needs the runs the law was fitted to."_html)
          : table(time_table(report)) + time_failures(report) + show(group, pictures);
  return section("time", "Error against run time"_html, content);
}

Html run_label(const RunComparison& run) {
  return code(run.data.name) + text(", " + degrees(run.data.conditions.inclination));
}

std::vector<const RunComparison*> runs_of(const Report& report, SampleKind kind) {
  std::vector<const RunComparison*> result;
  for (const RunComparison& run : report.runs) {
    if (run.kind == kind) result.push_back(&run);
  }
  for (const RunComparison& run : report.left_out) {
    if (run.kind == kind) result.push_back(&run);
  }
  return result;
}

}  // namespace grainlaw::report
