#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figure.h"
#include "apps/report/material_law.h"
#include "apps/report/material_plot.h"

namespace grainlaw::report {
namespace {

using calibration::State;
using calibration::StatePoint;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// How far two states are apart, in factors; Bo does not count.
double distance(const State& one, const State& other, bool of_inertia_too) {
  double sum = std::abs(std::log(one.softness / other.softness));
  if (one.softness == other.softness) sum = 0.0;  // rigid grains
  return sum +
         (of_inertia_too ? std::abs(std::log(one.inertial_number / other.inertial_number)) : 0.0);
}

/// The line a point belongs to; -1: none.
double line_of(const std::vector<LawLine>& lines, const State& state, bool of_inertia_too) {
  constexpr double farthest = 0.2;
  double best = farthest;
  double result = -1.0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const double apart = distance(lines[k].states.front(), state, of_inertia_too);
    if (!(apart < best)) continue;
    best = apart;
    result = static_cast<double>(k);
  }
  return result;
}

double weight(const std::vector<double>& weights, std::size_t i) {
  return i < weights.size() ? weights[i] : 0.0;
}

Csv points_csv(const MaterialReport& material) {
  Csv csv{.columns = {"I",
                      "I error",
                      "p*",
                      "Bo",
                      "mu",
                      "mu error",
                      "phi",
                      "phi error",
                      "mu ratio",
                      "mu ratio error",
                      "phi ratio",
                      "phi ratio error",
                      "mu residual",
                      "phi residual",
                      "mu weight",
                      "phi weight",
                      "inertia line",
                      "cohesion line"},
          .rows = {}};
  for (std::size_t i = 0; i < material.points.size(); ++i) {
    const StatePoint& point = material.points[i];
    const State state = state_of(point);
    const LawValue base = law_at(material.fit.table, without_cohesion(state));
    const LawValue left = residual(material, point);
    const bool cohesive = state.bond_number > 0.0;
    csv.rows.push_back({state.inertial_number,
                        point.inertial_number.error,
                        state.softness,
                        state.bond_number,
                        point.friction.value,
                        point.friction.error,
                        point.volume_fraction.value,
                        point.volume_fraction.error,
                        point.friction.value / base.friction,
                        point.friction.error / base.friction,
                        point.volume_fraction.value / base.volume_fraction,
                        point.volume_fraction.error / base.volume_fraction,
                        left.friction,
                        left.volume_fraction,
                        weight(material.fit.friction_weight, i),
                        weight(material.fit.fraction_weight, i),
                        cohesive ? -1.0 : line_of(material.against_inertia, state, false),
                        line_of(material.against_cohesion, state, true)});
  }
  return csv;
}

/// One column of a line: law, band and reference, all over what the law is without cohesion where
/// the line runs along Bo.
Csv line_csv(const MaterialReport& material, const LawLine& line, bool along_cohesion) {
  Csv csv{.columns = {"x",
                      "mu",
                      "mu lower",
                      "mu upper",
                      "mu reference",
                      "phi",
                      "phi lower",
                      "phi upper",
                      "phi reference"},
          .rows = {}};
  for (std::size_t k = 0; k < line.states.size(); ++k) {
    const State& state = line.states[k];
    LawValue unit{1.0, 1.0}, reference_unit{1.0, 1.0};
    const LawValue law = law_at(material.fit.table, state);
    LawValue reference{nan, nan};
    if (material.reference) reference = law_at(*material.reference, state);
    if (along_cohesion) {
      unit = law_at(material.fit.table, without_cohesion(state));
      if (material.reference) {
        reference_unit = law_at(*material.reference, without_cohesion(state));
      }
    }
    const auto bound = [&](const std::vector<double>& values, double by) {
      return k < values.size() ? values[k] / by : nan;
    };
    const calibration::MaterialBand band = line.band.value_or(calibration::MaterialBand{});
    csv.rows.push_back({along_cohesion ? state.bond_number : state.inertial_number,
                        law.friction / unit.friction,
                        bound(band.friction.lower, unit.friction),
                        bound(band.friction.upper, unit.friction),
                        reference.friction / reference_unit.friction,
                        law.volume_fraction / unit.volume_fraction,
                        bound(band.volume_fraction.lower, unit.volume_fraction),
                        bound(band.volume_fraction.upper, unit.volume_fraction),
                        reference.volume_fraction / reference_unit.volume_fraction});
  }
  return csv;
}

/// A picture of one quantity: lines of the law and the points that belong to them.
struct Plot {
  std::string name;
  std::string quantity;  ///< "mu" or "phi"
  std::string column;    ///< of the points
  bool along_cohesion = false;
  std::string y_label;
};

const std::vector<LawLine>& lines_of(const MaterialReport& material, const Plot& plot) {
  return plot.along_cohesion ? material.against_cohesion : material.against_inertia;
}

std::string line_file(const Plot& plot, std::size_t k) {
  return fmt::format("material_{}_{}.csv", plot.along_cohesion ? "cohesion" : "inertia", k + 1);
}

std::string line_title(const LawLine& line, bool along_cohesion) {
  const State& state = line.states.front();
  const std::string softness = "{/:Italic p}* " + fmt::format("{:.2g}", state.softness);
  if (!along_cohesion) return softness;
  return "{/:Italic I} " + fmt::format("{:.2g}, ", state.inertial_number) + softness;
}

bool has_left_out(const MaterialReport& material) {
  const auto none = [](double w) { return !(w > 0.0); };
  const calibration::MaterialFit& fit = material.fit;
  return std::any_of(fit.friction_weight.begin(), fit.friction_weight.end(), none) ||
         std::any_of(fit.fraction_weight.begin(), fit.fraction_weight.end(), none);
}

std::string points_part(const Plot& plot, std::size_t k, bool used) {
  const char* line = plot.along_cohesion ? "cohesion line" : "inertia line";
  return fmt::format(
      "'{}' using (column(\"{}\") == {} && column(\"{} weight\") {} 0 ? column(\"{}\") : "
      "NaN):\"{}\"{}:\"{} error\" with {} pt {} ps 0.6 lc rgb '{}' notitle",
      points_file,
      line,
      k,
      plot.quantity,
      used ? ">" : "==",
      plot.along_cohesion ? "Bo" : "I",
      plot.column,
      plot.along_cohesion ? "" : ":\"I error\"",
      plot.column,
      plot.along_cohesion ? "yerrorbars" : "xyerrorbars",
      used ? material_series(k).filled : material_series(k).hollow,
      material_series(k).colour);
}

std::string law_parts(const MaterialReport& material, const Plot& plot) {
  std::vector<std::string> parts;
  const std::vector<LawLine>& lines = lines_of(material, plot);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const MaterialSeries& look = material_series(k);
    const std::string file = line_file(plot, k);
    if (lines[k].band) {
      parts.push_back(
          fmt::format("'{0}' using \"x\":\"{1} lower\":\"{1} upper\" with filledcurves "
                      "fc rgb '{2}' fs transparent solid 0.2 noborder notitle",
                      file,
                      plot.quantity,
                      look.colour));
    }
    if (material.reference) {
      parts.push_back(fmt::format(
          "'{}' using \"x\":\"{} reference\" with lines lw 1 dt (3,3) lc rgb '{}' notitle",
          file,
          plot.quantity,
          look.colour));
    }
    parts.push_back(
        fmt::format("'{}' using \"x\":\"{}\" with lines lw 1.4 dt {} lc rgb '{}' "
                    "notitle",
                    file,
                    plot.quantity,
                    look.dash,
                    look.colour));
    parts.push_back(points_part(plot, k, true));
    parts.push_back(points_part(plot, k, false));
    parts.push_back(
        fmt::format("keyentry with linespoints lw 1.4 dt {} pt {} ps 0.6 lc rgb '{}' "
                    "title '{}'",
                    look.dash,
                    look.filled,
                    look.colour,
                    line_title(lines[k], plot.along_cohesion)));
  }
  if (has_left_out(material)) {
    parts.push_back(fmt::format("keyentry with points pt 6 ps 0.6 lc rgb '{}' title 'not fitted'",
                                colour::band));
  }
  if (material.reference) {
    parts.push_back(fmt::format("keyentry with lines lw 1 dt (3,3) lc rgb 'black' title '{}'",
                                plot_text(material.reference_name)));
  }
  return plot_of(parts);
}

Figure law_figure(const MaterialReport& material,
                  const Plot& plot,
                  const std::string& label,
                  const Html& caption) {
  std::string script = material_head(plot.name);
  script += plot.along_cohesion
                ? "set xlabel 'Bo'\nset xrange [0:*]\nset offsets graph 0.02, "
                  "graph 0.03, graph 0.05, graph 0.05\n"
                : inertia_axis(material) + "set offsets 0, 0, graph 0.05, graph 0.05\n";
  script += "set ylabel '" + plot.y_label + "'\n" + law_parts(material, plot);
  return {.name = plot.name, .script = script, .label = label, .caption = caption};
}

Html band_words(const MaterialReport& material) {
  if (material.against_inertia.empty() || !material.against_inertia.front().band) return {};
  return ". Bands: 95 %, moving-block bootstrap"_html;
}

void add_lines(const MaterialReport& material, FigureGroup& group) {
  group.data[points_file] = points_csv(material);
  for (const bool cohesion : {false, true}) {
    const Plot plot{
        .name = {}, .quantity = {}, .column = {}, .along_cohesion = cohesion, .y_label = {}};
    const std::vector<LawLine>& lines = lines_of(material, plot);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      group.data[line_file(plot, k)] = line_csv(material, lines[k], cohesion);
    }
  }
}

FigureGroup inertia_group(const MaterialReport& material) {
  FigureGroup group;
  if (material.against_inertia.empty()) return group;
  group.figures.push_back(law_figure(
      material,
      {.name = "material_friction", .quantity = "mu", .column = "mu", .y_label = "{/:Italic μ}"},
      "Friction against inertial number at each softness, points and law",
      "Friction without cohesion at each <i>p</i>*; hollow: not fitted"_html +
          band_words(material)));
  group.figures.push_back(
      law_figure(material,
                 {.name = "material_volume_fraction",
                  .quantity = "phi",
                  .column = "phi",
                  .y_label = "{/:Italic φ}"},
                 "Volume fraction against inertial number at each softness, points and law",
                 "Volume fraction without cohesion, same runs"_html));
  return group;
}

FigureGroup cohesion_group(const MaterialReport& material) {
  FigureGroup group;
  if (material.against_cohesion.empty()) return group;
  group.figures.push_back(
      law_figure(material,
                 {.name = "material_friction_cohesion",
                  .quantity = "mu",
                  .column = "mu ratio",
                  .along_cohesion = true,
                  .y_label = "{/:Italic μ} / {/:Italic μ}(Bo = 0)"},
                 "Friction over that without cohesion, against Bond number",
                 "What cohesion adds to friction: over the law at Bo = 0 and the same <i>I</i> and "
                 "<i>p</i>*"_html));
  group.figures.push_back(law_figure(
      material,
      {.name = "material_volume_fraction_cohesion",
       .quantity = "phi",
       .column = "phi ratio",
       .along_cohesion = true,
       .y_label = "{/:Italic φ} / {/:Italic φ}(Bo = 0)"},
      "Volume fraction over that without cohesion, against Bond number",
      "The same of the volume fraction: below 1 cohesion dilates, above 1 it compresses"_html));
  return group;
}

}  // namespace

std::vector<FigureGroup> material_figures(const MaterialReport& material) {
  std::vector<FigureGroup> groups = {inertia_group(material), cohesion_group(material)};
  add_lines(material, groups.front());
  FigureGroup& rest = groups.emplace_back();
  rest.figures.push_back(residual_figure(material));
  FigureGroup& cost = groups.emplace_back();
  add_cost_figures(material, cost);
  return groups;
}

}  // namespace grainlaw::report
