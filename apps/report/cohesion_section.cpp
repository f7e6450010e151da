#include "apps/report/cohesion_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "apps/report/numbers.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

using calibration::CohesionSeries;
using calibration::CohesivePoint;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Html estimate_text(const dem::Estimate& estimate) {
  return text(std::isfinite(estimate.value) ? with_error(estimate) : "–");
}

Html pairs_text(const CohesivePoint& point) {
  if (!point.at_bound) return estimate_text(point.yield_stress);
  return text(fmt::format("0 (+ {})", significant(point.yield_stress.error, 2)));
}

Table yield_table(const CohesionSeries& cohesion) {
  Table result{
      .caption =
          "Yield stress of chutes, in <i>mg</i>/<i>d</i>². <i>f<sub>a</sub></i>: largest "
          "attraction of a pair; <i>H</i>: height of the layer, <i>h</i>: of its flowing part; "
          "plug: the rows at the top that "
          "shear at less than 5 % of the fastest row, 3 <i>d</i> or more, its error that of "
          "2.5 or 10 % instead; "
          "<i>c</i><sub>0</sub> = <i>τ<sub>c</sub></i>(1 − <i>μ</i><sub>0</sub>/tan <i>θ</i>)."_html,
      .head = {"Run"_html,
               "<i>f<sub>a</sub></i>/(<i>mg</i>)"_html,
               "<i>θ</i>"_html,
               "<i>H</i>/<i>d</i>"_html,
               "<i>h</i>/<i>d</i>"_html,
               "Plug [<i>d</i>]"_html,
               "<i>τ<sub>c</sub></i>, weight of the plug"_html,
               "<i>τ<sub>c</sub></i>, stress–rate pairs"_html,
               "<i>c</i><sub>0</sub>"_html},
      .rows = {},
      .text_columns = 1};
  for (const CohesivePoint& point : cohesion.points) {
    result.rows.push_back(
        {code(point.name),
         text(significant(point.attraction, 3)),
         text(degrees(point.inclination)),
         text(fixed(point.layer_height, 1)),
         text(fixed(point.flowing_height(), 1)),
         text(point.plug ? fixed(point.plug->thickness, 1) : "none"),
         point.plug ? estimate_text(point.plug->yield_stress_from_weight) : text("–"),
         pairs_text(point),
         estimate_text(point.cohesion)});
  }
  return result;
}

Table one_value(const CohesionSeries& cohesion) {
  Table result{.caption = typeset(fmt::format(
                   "c0 over the tilts of a series, with mu0 = {} of the chutes without cohesion. "
                   "Chance: that runs with one c0 differ as much.",
                   with_error(*cohesion.mu0))),
               .head = {"Series"_html,
                        "<i>f<sub>a</sub></i>/(<i>mg</i>)"_html,
                        "<i>c</i><sub>0</sub>"_html,
                        "Runs"_html,
                        "Chance"_html},
               .rows = {},
               .text_columns = 1};
  for (const calibration::PooledCohesion& one : cohesion.pooled) {
    result.rows.push_back({text(one.series),
                           text(significant(one.attraction, 3)),
                           text(with_error(one.cohesion)),
                           text(fmt::format("{}", one.tilts)),
                           text(std::isfinite(one.chance) ? significant(one.chance, 2) : "–")});
  }
  return result;
}

/// Xi at h/2 of one run, beside its yield stress.
const calibration::ContactPoint* ratio_of(const SeriesReport& series, const std::string& run) {
  const auto found =
      std::ranges::find(series.contacts.points, run, &calibration::ContactPoint::name);
  return found == series.contacts.points.end() ? nullptr : &*found;
}

/// Runs that differ in their attraction only.
struct Group {
  std::string series;
  double inclination = 0.0;  ///< [rad]
  std::string label;         ///< in figures
};

/// By attraction, those without any at its left end.
Csv points_csv(const SeriesReport& series, const Group& group) {
  Csv csv{.columns = {"fa",
                      "tau_c weight",
                      "tau_c weight error",
                      "tau_c pairs",
                      "tau_c pairs error",
                      "Xi",
                      "Xi low",
                      "Xi high",
                      "Xi law"},
          .rows = {}};
  for (const CohesivePoint& point : series.cohesion->points) {
    const bool of_series = point.series == group.series || point.attraction == 0.0;
    if (point.inclination != group.inclination || !of_series) continue;
    const dem::Estimate weight =
        point.plug ? point.plug->yield_stress_from_weight : dem::Estimate{nan, nan};
    const calibration::ContactPoint* contacts = ratio_of(series, point.name);
    const auto xi =
        contacts ? contacts->ratio[1] : calibration::FittedCoefficient{.name = "Xi", .value = nan};
    csv.rows.push_back({point.attraction,
                        weight.value,
                        weight.error,
                        point.yield_stress.value,
                        point.yield_stress.error,
                        xi.value,
                        xi.interval.lower,
                        xi.interval.upper,
                        contacts ? contacts->ratio_of_law.value_or(nan) : nan});
  }
  std::ranges::sort(csv.rows, {}, [](const auto& row) { return row.front(); });
  return csv;
}

std::string file_of(std::size_t k) {
  return fmt::format("cohesion_{}.csv", k + 1);
}

/// In the order of the runs. The first series needs no name of its own.
std::vector<Group> groups_of(const CohesionSeries& cohesion) {
  std::vector<Group> groups;
  for (const CohesivePoint& point : cohesion.points) {
    if (point.attraction == 0.0) continue;
    const auto same = [&](const Group& group) {
      return group.series == point.series && group.inclination == point.inclination;
    };
    if (std::ranges::any_of(groups, same)) continue;
    const bool is_first = groups.empty() || point.series == groups.front().series;
    groups.push_back(
        {.series = point.series,
         .inclination = point.inclination,
         .label = degrees(point.inclination) + (is_first ? "" : ", " + plot_text(point.series))});
  }
  return groups;
}

std::string head(const std::string& name, const std::vector<Group>& groups, const char* y) {
  constexpr PlotSize size{.width = 480, .height = 360};
  std::vector<std::string> titles;
  for (const Group& group : groups) titles.push_back(group.label);
  return plot_head(name, size) + key_above(groups.size(), longest(titles), size) +
         fmt::format(
             "set xlabel '{{/:Italic f}}_a/({{/:Italic m g}})'\n"
             "set ylabel '{}'\nset xrange [-1:*]\nset yrange [0:*]\n",
             y);
}

/// Points of several groups at one attraction stand beside each other.
std::string abscissa(double place) {
  return fmt::format("(column(\"fa\") + {:.2f})", 0.25 * place);
}

std::string joined(const std::vector<std::string>& parts) {
  return fmt::format("{}\n", fmt::join(parts, ", \\\n     "));
}

Figure yield_figure(const std::vector<Group>& groups) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const auto place = static_cast<double>(2 * k);
    parts.push_back(fmt::format(
        "'{}' using {}:\"tau_c pairs\":\"tau_c pairs error\" with yerrorbars {} title '{}'",
        file_of(k),
        abscissa(place),
        point_style(k, 0.8),
        groups[k].label));
    parts.push_back(fmt::format(
        "'{}' using {}:\"tau_c weight\":\"tau_c weight error\" with yerrorbars {} notitle",
        file_of(k),
        abscissa(place + 1.0),
        hollow_style(k, 0.9)));
  }
  return {
      .name = "cohesion_yield",
      .script = head("cohesion_yield", groups, "{/:Italic τ}_c {/:Italic d}²/({/:Italic m g})") +
                "plot " + joined(parts),
      .label = "Yield stress against attraction",
      .caption =
          "Yield stress on the incline, from stress–rate pairs (filled) and from the weight "
          "of the plug (hollow); beside each other: one attraction. Bars: one standard error"_html};
}

/// An interval without a useful upper end must not flatten all others.
double ratio_end(const SeriesReport& series) {
  double largest = 0.0;
  for (const calibration::ContactPoint& point : series.contacts.points) {
    const double value = point.ratio[1].value;
    if (std::isfinite(value)) largest = std::fmax(largest, value);
    if (point.ratio_of_law) largest = std::fmax(largest, *point.ratio_of_law);
  }
  return largest > 0.0 ? 1.5 * largest : 1.0;
}

Figure ratio_figure(const SeriesReport& series, const std::vector<Group>& groups, bool with_law) {
  std::vector<std::string> parts;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    parts.push_back(
        fmt::format("'{}' using {}:\"Xi\":\"Xi low\":\"Xi high\" with yerrorbars {} title '{}'",
                    file_of(k),
                    abscissa(static_cast<double>(k)),
                    point_style(k, 0.8),
                    groups[k].label));
    if (!with_law) continue;
    parts.push_back(fmt::format(
        "'{}' using \"fa\":\"Xi law\" with lines {} notitle", file_of(k), line_style(k)));
  }
  return {.name = "cohesion_ratio",
          .script = head("cohesion_ratio", groups, "{/:Italic Ξ} at half the flowing height") +
                    fmt::format("set yrange [0:{:.3g}]\nplot ", ratio_end(series)) + joined(parts),
          .label = "Ratio of the linear to the quadratic stress against attraction",
          .caption =
              "<i>Ξ</i> at half the flowing height; bars: 95 %, none where <i>Ξ</i> has no "
              "limit, cut off at the axis; "
              "lines: the flow a law without lifetimes of contacts predicts"_html};
}

}  // namespace

Html cohesion_tables(const CohesionSeries& cohesion) {
  std::vector<Html> items;
  for (const std::string& sentence : cohesion.left_out) items.push_back(typeset(sentence));
  return table(yield_table(cohesion)) + (cohesion.mu0 ? table(one_value(cohesion)) : Html{}) +
         (items.empty() ? Html{} : list(items));
}

std::map<std::string, Csv> cohesion_data(const SeriesReport& series) {
  std::map<std::string, Csv> data;
  const std::vector<Group> groups = groups_of(*series.cohesion);
  for (std::size_t k = 0; k < groups.size(); ++k) data[file_of(k)] = points_csv(series, groups[k]);
  return data;
}

std::vector<Figure> cohesion_figures(const SeriesReport& series) {
  const std::vector<Group> groups = groups_of(*series.cohesion);
  return {yield_figure(groups), ratio_figure(series, groups, !series.law_name.empty())};
}

}  // namespace grainlaw::report
