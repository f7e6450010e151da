#include "apps/report/material_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "apps/report/material_law.h"
#include "apps/report/sections.h"
#include "apps/report/typeset.h"

namespace grainlaw::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr PlotSize law_size{.width = 520, .height = 380};

constexpr std::array<MaterialSeries, material_series_count> series = {
    {{7, 6, "1", colour::measured},
     {5, 4, "(12,4)", colour::predicted},
     {9, 8, "(6,3,2,3)", colour::third},
     {13, 12, "(2,3)", colour::fourth},
     {11, 10, "(12,3,2,3,2,3)", colour::band},
     {15, 14, "(6,6)", "black"}}};

continuum::Range inertia_range(const MaterialReport& material) {
  continuum::Range range{1e300, 0.0};
  for (const calibration::StatePoint& point : material.points) {
    if (!(point.inertial_number.value > 0.0)) continue;
    range.lower = std::min(range.lower, point.inertial_number.value);
    range.upper = std::max(range.upper, point.inertial_number.value);
  }
  return {0.8 * range.lower, 1.25 * range.upper};
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

Csv cost_csv(const MaterialReport& material, bool friction) {
  const calibration::FitSummary& fit =
      friction ? material.fit.friction : material.fit.volume_fraction;
  Csv csv{.columns = {"DEM wall time [s]"}, .rows = {}};
  for (const auto& c : fit.coefficients) csv.columns.push_back(c.name);
  for (const calibration::CostPoint& point : material.cost) {
    const auto& values = friction ? point.friction : point.volume_fraction;
    if (values.size() != fit.coefficients.size()) continue;
    std::vector<double>& row = csv.rows.emplace_back();
    row.push_back(point.dem_wall_seconds);
    for (const dem::Estimate& value : values) {
      const double relative = std::abs(value.error / value.value);
      row.push_back(relative > 0.0 && std::isfinite(relative) ? relative : nan);
    }
  }
  return csv;
}

std::string cost_axes(const Csv& csv) {
  double low = 1e300, high = 0.0, at_end = 0.0;
  for (const std::vector<double>& row : csv.rows) {
    for (std::size_t k = 1; k < row.size(); ++k) {
      low = std::fmin(low, row[k]);
      high = std::fmax(high, row[k]);
    }
  }
  for (std::size_t k = 1; k < csv.columns.size(); ++k) {
    at_end = std::fmax(at_end, csv.rows.back()[k] * std::sqrt(csv.rows.back()[0]));
  }
  return "set logscale xy\n" + log_axis('x', 0.85 * csv.rows.front()[0], 1.2 * csv.rows.back()[0]) +
         log_axis('y', 0.6 * low, 1.8 * high) +
         fmt::format("guide(x) = {:.6g} / sqrt(x)\n", at_end);
}

void add_cost_figure(const MaterialReport& material, bool friction, FigureGroup& group) {
  const Csv csv = cost_csv(material, friction);
  if (csv.rows.size() < 2) return;
  const std::string name = friction ? "material_cost_mu" : "material_cost_phi";
  std::vector<std::string> parts = {
      fmt::format("guide(x) with lines lw 1 dt (2,4) lc rgb '{}' title 'slope −½'", colour::band)};
  for (std::size_t k = 1; k < csv.columns.size(); ++k) {
    const MaterialSeries& look = material_series(k - 1);
    parts.push_back(
        fmt::format("'{}.csv' using \"{}\":\"{}\" with linespoints lw 1.2 dt {} pt {} "
                    "ps 0.6 lc rgb '{}' title '{}'",
                    name,
                    csv.columns[0],
                    csv.columns[k],
                    look.dash,
                    k > series.size() ? look.hollow : look.filled,
                    look.colour,
                    plot_symbol(coefficient_symbol(csv.columns[k]))));
  }
  group.data[name + ".csv"] = csv;
  group.figures.push_back(
      {.name = name,
       .script = material_head(name) + cost_axes(csv) +
                 "set xlabel 'DEM wall time of all fitted runs [s]'\n"
                 "set ylabel 'relative standard error'\n" +
                 plot_of(parts),
       .label = "Error of every coefficient against DEM run time",
       .caption = friction
                      ? "Coefficients of the friction law against DEM time: all runs with 1/16 to "
                        "all of their averaging time, start-up included"_html
                      : "The same of the volume fraction law"_html});
}

}  // namespace

const MaterialSeries& material_series(std::size_t k) {
  return series[k % series.size()];
}

std::string plot_of(const std::vector<std::string>& parts) {
  std::string command = "plot ";
  for (const std::string& part : parts) {
    if (&part != &parts.front()) command += ", \\\n     ";
    command += part;
  }
  return command + "\n";
}

std::string material_head(const std::string& name) {
  return plot_head(name, law_size) + fmt::format(
                                         "set tmargin at screen {:.3f}\n"
                                         "set key width 0 samplen 2.4\n",
                                         1.0 - 70.0 / law_size.height);
}

std::string inertia_axis(const MaterialReport& material) {
  const continuum::Range range = inertia_range(material);
  return "set logscale x\n" + log_axis('x', range.lower, range.upper) + "set xtics (" +
         log_tics({1.0, 2.0, 5.0}) +
         ")\n"
         "set xlabel '{/:Italic I}'\n";
}

/// A little beyond the largest residual of a fitted point: points outside the range of the fit may
/// lie ten times as far.
double residual_end(const MaterialReport& material) {
  double largest = 4.0;
  for (std::size_t i = 0; i < material.points.size(); ++i) {
    const LawValue left = residual(material, material.points[i]);
    if (material.fit.friction_weight[i] > 0.0)
      largest = std::fmax(largest, std::abs(left.friction));
    if (material.fit.fraction_weight[i] > 0.0)
      largest = std::fmax(largest, std::abs(left.volume_fraction));
  }
  return 1.1 * largest;
}

Figure residual_figure(const MaterialReport& material) {
  std::string script = material_head("material_residuals") + inertia_axis(material);
  script += "set ylabel '(measured − law) / s.e.'\n";
  script += fmt::format("set yrange [-{0:.3g}:{0:.3g}]\n", residual_end(material));
  script += fmt::format(
      "plot 0 with lines lw 0.8 lc rgb 'black' notitle, \\\n"
      "     2 with lines lw 0.8 dt (2,3) lc rgb 'black' title '± 2 s.e.', \\\n"
      "     -2 with lines lw 0.8 dt (2,3) lc rgb 'black' notitle, \\\n     {}, \\\n     {}, "
      "\\\n     {}, \\\n     {}\n",
      residual_part("mu", true, 7, colour::measured, "{/:Italic μ}"),
      residual_part("mu", false, 6, colour::measured, ""),
      residual_part("phi", true, 5, colour::predicted, "{/:Italic φ}"),
      residual_part("phi", false, 4, colour::predicted, "not fitted: hollow"));
  return {
      .name = "material_residuals",
      .script = script,
      .label = "Residuals of both laws in standard errors, against inertial number",
      .caption =
          "What the laws leave of every point, in standard errors of the measured "
          "value. Points far outside ± 2 are missed by the law, not by chance; hollow ones farther "
          "off than any fitted point are in the table only"_html};
}

void add_cost_figures(const MaterialReport& material, FigureGroup& group) {
  add_cost_figure(material, true, group);
  add_cost_figure(material, false, group);
}

}  // namespace grainlaw::report
