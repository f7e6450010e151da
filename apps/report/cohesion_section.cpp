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
        {text(point.name),
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

Html one_value(const CohesionSeries& cohesion) {
  if (!cohesion.mu0) return {};
  std::string sentence =
      fmt::format("mu0 = {} from the chutes without cohesion.", with_error(*cohesion.mu0));
  for (const calibration::PooledCohesion& one : cohesion.pooled) {
    sentence += fmt::format(" {}, f_a = {} m g: c0 = {}",
                            one.series,
                            significant(one.attraction, 3),
                            with_error(one.cohesion));
    sentence += std::isfinite(one.chance)
                    ? fmt::format(
                          " over {} runs, which {} (probability that one value scatters "
                          "as much: {}).",
                          one.tilts,
                          one.chance < 0.05 ? "do not agree" : "agree",
                          significant(one.chance, 2))
                    : ".";
  }
  return paragraph(typeset(sentence));
}

/// Xi at h/2 of one run, beside its yield stress.
const calibration::ContactPoint* ratio_of(const SeriesReport& series, const std::string& run) {
  const auto found =
      std::ranges::find(series.contacts.points, run, &calibration::ContactPoint::name);
  return found == series.contacts.points.end() ? nullptr : &*found;
}

/// Points of one tilt, by attraction.
Csv points_csv(const SeriesReport& series, double inclination) {
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
    if (point.inclination != inclination) continue;
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

/// Tilts of the cohesive runs, in the order of the runs.
std::vector<double> tilts_of(const CohesionSeries& cohesion) {
  std::vector<double> tilts;
  for (const CohesivePoint& point : cohesion.points) {
    if (point.attraction == 0.0) continue;
    if (std::ranges::find(tilts, point.inclination) == tilts.end()) {
      tilts.push_back(point.inclination);
    }
  }
  return tilts;
}

std::string head(const std::string& name, const char* y) {
  return plot_head(name, {.width = 480, .height = 360}) +
         fmt::format(
             "set tmargin at screen 0.76\nset xlabel '{{/:Italic f}}_a/({{/:Italic m g}})'\n"
             "set ylabel '{}'\nset xrange [-1:*]\nset yrange [0:*]\nplot ",
             y);
}

Figure yield_figure(const std::vector<double>& tilts) {
  std::string parts;
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    parts += fmt::format(
        "{0}'{1}' using \"fa\":\"tau_c pairs\":\"tau_c pairs error\" with yerrorbars {2} title "
        "'{3}, pairs', \\\n     '{1}' using \"fa\":\"tau_c weight\":\"tau_c weight error\" with "
        "yerrorbars {4} title '{3}, weight of the plug'",
        k == 0 ? "" : ", \\\n     ",
        file_of(k),
        point_style(2 * k),
        degrees(tilts[k]),
        point_style(2 * k + 1));
  }
  return {.name = "cohesion_yield",
          .script = head("cohesion_yield", "τ_c {/:Italic d}²/({/:Italic m g})") + parts + "\n",
          .label = "Yield stress against attraction",
          .caption =
              "Yield stress on the incline, from stress–rate pairs and from the weight of "
              "the plug; bars: one standard error"_html};
}

Figure ratio_figure(const std::vector<double>& tilts, bool with_law) {
  std::string parts;
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    parts += fmt::format(
        "{}'{}' using \"fa\":\"Xi\":\"Xi low\":\"Xi high\" with yerrorbars {} title '{}'",
        k == 0 ? "" : ", \\\n     ",
        file_of(k),
        point_style(k),
        degrees(tilts[k]));
    if (!with_law) continue;
    parts += fmt::format(", \\\n     '{}' using \"fa\":\"Xi law\" with lines {} title '{}, law'",
                         file_of(k),
                         line_style(k),
                         degrees(tilts[k]));
  }
  return {.name = "cohesion_ratio",
          .script = head("cohesion_ratio", "Ξ at half the flowing height") + parts + "\n",
          .label = "Ratio of the linear to the quadratic stress against attraction",
          .caption =
              "<i>Ξ</i> at half the flowing height; bars: 95 %, none where Ξ has no limit; "
              "lines: the flow a law without lifetimes of contacts predicts"_html};
}

}  // namespace

Html cohesion_tables(const CohesionSeries& cohesion) {
  std::vector<Html> items;
  for (const std::string& sentence : cohesion.left_out) items.push_back(typeset(sentence));
  return table(yield_table(cohesion)) + one_value(cohesion) +
         (items.empty() ? Html{} : list(items));
}

std::map<std::string, Csv> cohesion_data(const SeriesReport& series) {
  std::map<std::string, Csv> data;
  const std::vector<double> tilts = tilts_of(*series.cohesion);
  for (std::size_t k = 0; k < tilts.size(); ++k) data[file_of(k)] = points_csv(series, tilts[k]);
  return data;
}

std::vector<Figure> cohesion_figures(const SeriesReport& series) {
  const std::vector<double> tilts = tilts_of(*series.cohesion);
  return {yield_figure(tilts), ratio_figure(tilts, !series.law_name.empty())};
}

}  // namespace grainlaw::report
