#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/report/figure.h"
#include "apps/report/material_law.h"
#include "apps/report/numbers.h"

namespace grainlaw::report {
namespace {

using calibration::State;
using calibration::StatePoint;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr PlotSize law_size{.width = 520, .height = 380};
constexpr const char* points_file = "material_points.csv";

/// Lines that differ in mark, dash and colour, so that a figure can be read without its colours.
struct Series {
  int filled, hollow;  // gnuplot point types
  std::string_view dash, colour;
};
constexpr std::array<Series, 6> series = {{{7, 6, "1", colour::measured},
                                           {5, 4, "(12,4)", colour::predicted},
                                           {9, 8, "(6,3,2,3)", colour::third},
                                           {13, 12, "(2,3)", colour::fourth},
                                           {11, 10, "(12,3,2,3,2,3)", colour::band},
                                           {15, 14, "(6,6)", "black"}}};
const Series& style(std::size_t k) {
  return series[k % series.size()];
}

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
      used ? style(k).filled : style(k).hollow,
      style(k).colour);
}

std::string law_parts(const MaterialReport& material, const Plot& plot) {
  std::vector<std::string> parts;
  const std::vector<LawLine>& lines = lines_of(material, plot);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const Series& look = style(k);
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
          "'{}' using \"x\":\"{} reference\" with lines lw 0.6 dt (1,2) lc rgb '{}' notitle",
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
    parts.push_back(fmt::format("keyentry with lines lw 0.6 dt (1,2) lc rgb 'black' title '{}'",
                                plot_text(material.reference_name)));
  }
  return fmt::format("plot {}\n", fmt::join(parts, ", \\\n     "));
}

/// Room for a key of two rows.
std::string head(const std::string& name) {
  return plot_head(name, law_size) + fmt::format(
                                         "set tmargin at screen {:.3f}\nset samplen 2.4\n"
                                         "set key width 0 samplen 2.4\n",
                                         1.0 - 70.0 / law_size.height);
}

continuum::Range inertia_range(const MaterialReport& material) {
  continuum::Range range{1e300, 0.0};
  for (const StatePoint& point : material.points) {
    if (!(point.inertial_number.value > 0.0)) continue;
    range.lower = std::min(range.lower, point.inertial_number.value);
    range.upper = std::max(range.upper, point.inertial_number.value);
  }
  return {0.8 * range.lower, 1.25 * range.upper};
}

std::string inertia_axis(const MaterialReport& material) {
  const continuum::Range range = inertia_range(material);
  return "set logscale x\n" + log_axis('x', range.lower, range.upper) +
         "set xlabel '{/:Italic I}'\n";
}

Figure law_figure(const MaterialReport& material,
                  const Plot& plot,
                  const std::string& label,
                  const Html& caption) {
  std::string script = head(plot.name);
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

std::string residual_part(
    const char* quantity, bool used, int shape, std::string_view colour, const std::string& title) {
  return fmt::format(
      "'{0}' using (column(\"{1} weight\") {2} 0 ? column(\"I\") : NaN):\"{1} residual\" with "
      "points pt {3} ps 0.6 lc rgb '{4}' {5}",
      points_file,
      quantity,
      used ? ">" : "==",
      shape,
      colour,
      title.empty() ? "notitle" : "title '" + title + "'");
}

Figure residual_figure(const MaterialReport& material) {
  std::string script = head("material_residuals") + inertia_axis(material);
  script += "set ylabel '(measured − law) / s.e.'\nset offsets 0, 0, graph 0.05, graph 0.05\n";
  script += fmt::format(
      "plot 0 with lines lw 0.8 lc rgb 'black' notitle, \\\n"
      "     2 with lines lw 0.8 dt (2,3) lc rgb 'black' title '± 2 s.e.', \\\n"
      "     -2 with lines lw 0.8 dt (2,3) lc rgb 'black' notitle, \\\n     {}, \\\n     {}, "
      "\\\n     {}, \\\n     {}\n",
      residual_part("mu", true, 7, colour::measured, "{/:Italic μ}"),
      residual_part("mu", false, 6, colour::measured, ""),
      residual_part("phi", true, 5, colour::predicted, "{/:Italic φ}"),
      residual_part("phi", false, 4, colour::predicted, "not fitted: hollow"));
  return {.name = "material_residuals",
          .script = script,
          .label = "Residuals of both laws in standard errors, against inertial number",
          .caption =
              "What the laws leave of every point, in standard errors of the measured "
              "value. Points far outside ± 2 are missed by the law, not by chance"_html};
}

std::string plain_name(const std::string& coefficient) {
  std::string result = coefficient;
  std::replace(result.begin(), result.end(), '_', ' ');
  return plot_text(result);
}

Csv cost_csv(const MaterialReport& material, bool friction) {
  const calibration::FitSummary& fit =
      friction ? material.fit.friction : material.fit.volume_fraction;
  Csv csv{.columns = {"DEM wall time [s]"}, .rows = {}};
  for (const auto& c : fit.coefficients) csv.columns.push_back(plain_name(c.name));
  for (const calibration::CostPoint& point : material.cost) {
    const auto& values = friction ? point.friction : point.volume_fraction;
    if (values.size() != fit.coefficients.size()) continue;
    std::vector<double>& row = csv.rows.emplace_back();
    row.push_back(point.dem_wall_seconds);
    for (const dem::Estimate& value : values) {
      const double relative = std::abs(value.error / value.value);
      row.push_back(relative > 0.0 ? relative : nan);
    }
  }
  return csv;
}

std::string cost_axes(const Csv& csv) {
  double low = 1e300, high = 0.0, at_start = 0.0;
  for (const std::vector<double>& row : csv.rows) {
    for (std::size_t k = 1; k < row.size(); ++k) {
      low = std::fmin(low, row[k]);
      high = std::fmax(high, row[k]);
    }
  }
  for (std::size_t k = 1; k < csv.columns.size(); ++k) {
    at_start = std::fmax(at_start, csv.rows.front()[k]);
  }
  return "set logscale xy\n" + log_axis('x', 0.85 * csv.rows.front()[0], 1.2 * csv.rows.back()[0]) +
         log_axis('y', 0.6 * low, 1.8 * high) +
         fmt::format("guide(x) = {:.6g} / sqrt(x)\n", at_start * std::sqrt(csv.rows.front()[0]));
}

void add_cost_figure(const MaterialReport& material, bool friction, FigureGroup& group) {
  const Csv csv = cost_csv(material, friction);
  if (csv.rows.size() < 2) return;
  const std::string name = friction ? "material_cost_mu" : "material_cost_phi";
  std::vector<std::string> parts = {
      fmt::format("guide(x) with lines lw 1 dt (2,4) lc rgb '{}' title 'slope −½'", colour::band)};
  for (std::size_t k = 1; k < csv.columns.size(); ++k) {
    const Series& look = style(k - 1);
    parts.push_back(
        fmt::format("'{}.csv' using \"{}\":\"{}\" with linespoints lw 1.2 dt {} pt {} "
                    "ps 0.6 lc rgb '{}' title '{}'",
                    name,
                    csv.columns[0],
                    csv.columns[k],
                    look.dash,
                    k > series.size() ? look.hollow : look.filled,
                    look.colour,
                    csv.columns[k]));
  }
  group.data[name + ".csv"] = csv;
  group.figures.push_back(
      {.name = name,
       .script = head(name) + cost_axes(csv) +
                 "set xlabel 'DEM wall time of all fitted runs [s]'\n"
                 "set ylabel 'relative standard error'\n" +
                 fmt::format("plot {}\n", fmt::join(parts, ", \\\n     ")),
       .label = "Error of every coefficient against DEM run time",
       .caption = friction
                      ? "Coefficients of the friction law against DEM time: all runs with 1/16 to "
                        "all of their averaging time, start-up included"_html
                      : "The same of the volume fraction law"_html});
}

}  // namespace

std::vector<FigureGroup> material_figures(const MaterialReport& material) {
  std::vector<FigureGroup> groups = {inertia_group(material), cohesion_group(material)};
  add_lines(material, groups.front());
  FigureGroup& rest = groups.emplace_back();
  rest.figures.push_back(residual_figure(material));
  FigureGroup& cost = groups.emplace_back();
  add_cost_figure(material, true, cost);
  add_cost_figure(material, false, cost);
  return groups;
}

}  // namespace grainlaw::report
