#include "apps/report/cohesion_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "apps/report/numbers.h"

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
    sentence += fmt::format(
        " f_a = {} m g: c0 = {}", significant(one.attraction, 3), with_error(one.cohesion));
    sentence += std::isfinite(one.chance)
                    ? fmt::format(
                          " over {} runs, which {} (probability that one value scatters "
                          "as much: {}).",
                          one.tilts,
                          one.chance < 0.05 ? "do not agree" : "agree",
                          significant(one.chance, 2))
                    : ".";
  }
  return paragraph(text(sentence));
}

/// Points of one tilt, by attraction.
Csv points_csv(const CohesionSeries& cohesion, double inclination) {
  Csv csv{
      .columns = {"fa", "tau_c weight", "tau_c weight error", "tau_c pairs", "tau_c pairs error"},
      .rows = {}};
  for (const CohesivePoint& point : cohesion.points) {
    if (point.inclination != inclination) continue;
    const dem::Estimate weight =
        point.plug ? point.plug->yield_stress_from_weight : dem::Estimate{nan, nan};
    csv.rows.push_back({point.attraction,
                        weight.value,
                        weight.error,
                        point.yield_stress.value,
                        point.yield_stress.error});
  }
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
  return plot_head(name, {.width = 480, .height = 340}) +
         fmt::format(
             "set tmargin at screen 0.78\nset xlabel '{{/:Italic f}}_a/({{/:Italic m g}})'\n"
             "set ylabel '{}'\nset xrange [-1:*]\nset yrange [0:*]\nplot ",
             y);
}

}  // namespace

Html cohesion_tables(const CohesionSeries& cohesion) {
  std::vector<Html> items;
  for (const std::string& sentence : cohesion.left_out) items.push_back(text(sentence));
  return table(yield_table(cohesion)) + one_value(cohesion) +
         (items.empty() ? Html{} : list(items));
}

FigureGroup cohesion_figures(const CohesionSeries& cohesion) {
  FigureGroup group;
  const std::vector<double> tilts = tilts_of(cohesion);
  std::string yield;
  for (std::size_t k = 0; k < tilts.size(); ++k) {
    const std::string file = file_of(k);
    const std::string tilt = degrees(tilts[k]);
    group.data[file] = points_csv(cohesion, tilts[k]);
    const char* separator = k == 0 ? "" : ", \\\n     ";
    yield += fmt::format(
        "{0}'{1}' using \"fa\":\"tau_c pairs\":\"tau_c pairs error\" with yerrorbars {2} title "
        "'{3}, pairs', \\\n     '{1}' using \"fa\":\"tau_c weight\":\"tau_c weight error\" with "
        "yerrorbars {4} title '{3}, weight of the plug'",
        separator,
        file,
        point_style(2 * k),
        tilt,
        point_style(2 * k + 1));
  }
  group.figures = {
      {.name = "cohesion_yield",
       .script = head("cohesion_yield", "τ_c {/:Italic d}²/({/:Italic m g})") + yield + "\n",
       .label = "Yield stress against attraction",
       .caption = "Yield stress on the incline, from stress–rate pairs and from the weight of the "
                  "plug; bars: one standard error"_html}};
  return group;
}

}  // namespace grainlaw::report
