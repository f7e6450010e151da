#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "apps/report/figure.h"
#include "apps/report/law_curve.h"

namespace grainlaw::report {
namespace {

constexpr PlotSize law_size{.width = 480, .height = 340};

std::vector<calibration::FlowPoint> points_of_runs(const Report& report, bool in_sample) {
  std::vector<calibration::FlowPoint> points;
  for (const RunComparison& run : report.runs) {
    const bool fitted = run.kind == calibration::SampleKind::in_sample;
    if (run.point && fitted == in_sample) points.push_back(*run.point);
  }
  return points;
}

std::vector<calibration::FlowPoint> fitted_points(const Report& report) {
  return report.fit ? report.fit->points : points_of_runs(report, true);
}

std::vector<calibration::FlowPoint> other_points(const Report& report) {
  return points_of_runs(report, false);
}

Csv points_csv(const std::vector<calibration::FlowPoint>& points) {
  Csv csv{.columns = {"inclination [deg]", "I", "I error", "mu", "mu error", "phi", "phi error"},
          .rows = {}};
  for (const calibration::FlowPoint& point : points) {
    csv.rows.push_back({point.inclination * 180.0 / std::numbers::pi,
                        point.inertial_number.value,
                        point.inertial_number.error,
                        point.friction.value,
                        point.friction.error,
                        point.volume_fraction.value,
                        point.volume_fraction.error});
  }
  return csv;
}

Csv curve_csv(const std::vector<LawPoint>& curve) {
  Csv csv{.columns = {"I", "mu", "mu lower", "mu upper", "phi", "phi lower", "phi upper"},
          .rows = {}};
  for (const LawPoint& point : curve) {
    const dem::Estimate& mu = point.friction;
    const dem::Estimate& phi = point.volume_fraction;
    csv.rows.push_back({point.inertial_number,
                        mu.value,
                        mu.value - mu.error,
                        mu.value + mu.error,
                        phi.value,
                        phi.value - phi.error,
                        phi.value + phi.error});
  }
  return csv;
}

/// From a little below the lowest to a little above the highest I met, from data or table range.
continuum::Range shown_range(const Report& report) {
  continuum::Range range = report.table.range.inertial_number.value_or(
      continuum::Range{.lower = std::numeric_limits<double>::infinity(), .upper = 0.0});
  std::vector<calibration::FlowPoint> points = other_points(report);
  const std::vector<calibration::FlowPoint> fitted = fitted_points(report);
  points.insert(points.end(), fitted.begin(), fitted.end());
  for (const calibration::FlowPoint& point : points) {
    range.lower = std::min(range.lower, point.inertial_number.value);
    range.upper = std::max(range.upper, point.inertial_number.value);
  }
  const double margin = 0.08 * (range.upper - range.lower);
  return {.lower = std::max(0.0, range.lower - margin), .upper = range.upper + margin};
}

/// p* in the middle of the fitted rows; a law without softness does not ask for it.
double typical_softness(const Report& report) {
  double sum = 0.0;
  const std::vector<calibration::FlowPoint> points = fitted_points(report);
  for (const auto& point : points) sum += 0.5 * (point.softness_lower + point.softness_upper);
  return points.empty() ? 0.0 : sum / static_cast<double>(points.size());
}

std::string curve_parts(const Report& report, const std::string& column) {
  const bool band = report.table.covariance.has_value();
  const auto range = report.table.range.inertial_number.value_or(continuum::Range{0.0, 1e300});
  std::string parts;
  if (band) {
    parts += fmt::format(
        "'law_curve.csv' using \"I\":\"{0} lower\":\"{0} upper\" with filledcurves "
        "fc rgb '{1}' fs transparent solid 0.25 noborder title '± 1 s.e.', \\\n     ",
        column,
        colour::band);
  }
  parts += fmt::format(
      "'law_curve.csv' using (column(\"I\") >= {1:.6g} && column(\"I\") <= {2:.6g} ? "
      "column(\"I\") : NaN):\"{0}\" with lines lw 1.6 lc rgb 'black' title 'law', \\\n     "
      "'law_curve.csv' using \"I\":\"{0}\" with lines lw 1 dt (3,3) lc rgb 'black' notitle",
      column,
      range.lower,
      range.upper);
  return parts;
}

std::string point_part(const std::string& file,
                       const std::string& column,
                       const char* title,
                       std::size_t style) {
  return fmt::format(
      ", \\\n     '{0}' using \"I\":\"{1}\":\"I error\":\"{1} error\" with xyerrorbars {2} "
      "title '{3}'",
      file,
      column,
      point_style(style),
      title);
}

std::string script(const Report& report,
                   const std::string& name,
                   const std::string& column,
                   const std::string& symbol) {
  std::string result = plot_head(name, law_size);
  result += "set xlabel '{/:Italic I}'\n";
  result += "set ylabel '" + symbol + "'\n";
  result += "set offsets 0, 0, graph 0.05, graph 0.05\n";
  result += "plot " + curve_parts(report, column);
  if (!fitted_points(report).empty()) {
    result += point_part("law_fitted.csv", column, "DEM, fitted", 0);
  }
  if (!other_points(report).empty()) {
    result += point_part("law_other.csv", column, "DEM, not fitted", 1);
  }
  return result + "\n";
}

}  // namespace

FigureGroup law_figures(const Report& report) {
  FigureGroup group;
  const continuum::Range range = shown_range(report);
  if (!std::holds_alternative<continuum::MuPhi>(report.table.law) || !(range.upper > range.lower)) {
    return group;
  }
  group.data["law_curve.csv"] =
      curve_csv(law_curve(report.table, range, typical_softness(report), 101));
  if (!fitted_points(report).empty())
    group.data["law_fitted.csv"] = points_csv(fitted_points(report));
  if (!other_points(report).empty()) group.data["law_other.csv"] = points_csv(other_points(report));
  group.figures.push_back(
      {.name = "law_friction",
       .script = script(report, "law_friction", "mu", "{/:Italic μ}"),
       .label = "Friction against inertial number, DEM points and law",
       .caption = "Friction <i>μ</i>(<i>I</i>). Dotted where no data lie"_html});
  group.figures.push_back({.name = "law_volume_fraction",
                           .script = script(report, "law_volume_fraction", "phi", "{/:Italic φ}"),
                           .label = "Volume fraction against inertial number, DEM points and law",
                           .caption = "Volume fraction <i>φ</i>(<i>I</i>), same points"_html});
  return group;
}

}  // namespace grainlaw::report
