#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/report/figure.h"
#include "apps/report/numbers.h"

namespace grainlaw::report {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr const char* data_file = "error_against_time.csv";

/// Logarithmic axes have no place for zero.
double positive(double number) {
  return number > 0.0 ? number : nan;
}

double entry(const std::vector<double>& values, std::size_t k) {
  return k < values.size() ? values[k] : nan;
}

/// Time unit of the runs; all runs of one report share it.
double time_unit(const Report& report) {
  return report.runs.empty() ? 1.0 : scales(report.runs.front().data.conditions).time;
}

std::string run_column(const Report& report, std::size_t k) {
  return fmt::format("{} {}", k + 1, plot_text(report.runs[k].data.name));
}

Csv error_csv(const Report& report) {
  Csv csv{.columns = {"averaging time [sqrt(d/g)]",
                      "DEM wall time [s]",
                      "law error",
                      "law standard error"},
          .rows = {}};
  for (std::size_t k = 0; k < report.runs.size(); ++k) {
    csv.columns.push_back(run_column(report, k));
    csv.columns.push_back(run_column(report, k) + " error");
  }
  for (const TimeErrorPoint& point : report.error_against_time) {
    if (!point.failure.empty()) continue;
    std::vector<double> row = {point.averaging_time / time_unit(report),
                               point.dem_wall_seconds,
                               positive(point.law_error),
                               positive(point.law_standard_error)};
    for (std::size_t k = 0; k < report.runs.size(); ++k) {
      row.push_back(positive(entry(point.profile_error, k)));
      row.push_back(positive(entry(point.profile_standard_error, k)));
    }
    csv.rows.push_back(row);
  }
  return csv;
}

/// A line of slope -1/2 through the largest value at the earliest time: y = level / sqrt(x).
std::string guide(const Csv& csv, std::size_t x, std::size_t first_column, std::size_t step) {
  for (const std::vector<double>& row : csv.rows) {
    double largest = nan;
    for (std::size_t k = first_column; k < row.size(); k += step) {
      largest = std::fmax(largest, row[k]);
    }
    if (largest > 0.0 && row[x] > 0.0) {
      return fmt::format("{:.6g} / sqrt(x) with lines lw 1 dt (2,4) lc rgb '{}' title 'slope −½'",
                         1.3 * largest * std::sqrt(row[x]),
                         colour::band);
    }
  }
  return {};
}

/// Axis over the columns first, first + step, ... below end, with a margin for the marks.
std::string value_axis(const Csv& csv, std::size_t first, std::size_t step, std::size_t end) {
  double lowest = nan;
  double highest = nan;
  for (const std::vector<double>& row : csv.rows) {
    for (std::size_t k = first; k < end; k += step) {
      lowest = std::fmin(lowest, row[k]);  // fmin and fmax pass over NaN
      highest = std::fmax(highest, row[k]);
    }
  }
  return lowest > 0.0 ? log_axis('y', 0.6 * lowest, 1.6 * highest) : std::string{};
}

constexpr const char* time_label = "averaging time / √({/:Italic d}/{/:Italic g})";

std::string head(const std::string& name,
                 std::size_t entries,
                 const Csv& csv,
                 std::size_t x,
                 const std::string& x_label,
                 const std::string& y_label) {
  return plot_head(name) + key_above(entries, entries > 3 ? 8 : 16) + "set logscale xy\n" +
         log_axis('x', 0.8 * csv.rows.front()[x], 1.25 * csv.rows.back()[x]) +
         fmt::format("set xlabel '{}'\nset ylabel '{}'\n", x_label, y_label);
}

std::string law_script(const std::string& name, const Csv& csv) {
  const std::string shown = guide(csv, 0, 3, csv.columns.size());
  return head(name, 3, csv, 0, time_label, "relative error of {/:Italic I}") +
         value_axis(csv, 2, 1, 4) +
         fmt::format(
             "plot {3}'{0}' using \"{1}\":\"law standard error\" with linespoints "
             "lw 1.3 dt (6,4) {4} title 'claimed s.e.', \\\n     "
             "'{0}' using \"{1}\":\"law error\" with linespoints lw 1.3 {2} "
             "title 'off the full fit'\n",
             data_file,
             csv.columns[0],
             point_style(0),
             shown.empty() ? "" : shown + ", \\\n     ",
             point_style(1));
}

bool has_number(const Csv& csv, std::size_t column) {
  return std::any_of(csv.rows.begin(), csv.rows.end(), [&](const auto& row) {
    return std::isfinite(row[column]);
  });
}

/// Line of the k-th run, with error bars where they are known.
std::string run_part(const Report& report, const Csv& csv, std::size_t x, std::size_t k) {
  const std::size_t column = 4 + 2 * k;
  const bool errors = has_number(csv, column + 1);
  return fmt::format(
      "'{}' using \"{}\":\"{}\"{} lw 1.2 dt {} {} title '{}'",
      data_file,
      csv.columns[x],
      csv.columns[column],
      errors ? ":\"" + csv.columns[column + 1] + "\" with yerrorlines" : " with linespoints",
      k / 4 + 1,
      point_style(k),
      degrees(report.runs[k].data.conditions.inclination));
}

std::string profile_script(const Report& report,
                           const std::string& name,
                           const Csv& csv,
                           std::size_t x) {
  const char* label = x == 0 ? time_label : "DEM wall time of all fitted runs [s]";
  std::string parts = guide(csv, x, 4, 2);
  for (std::size_t k = 0; k < report.runs.size(); ++k) {
    if (!has_number(csv, 4 + 2 * k)) continue;
    parts += (parts.empty() ? "" : ", \\\n     ") + run_part(report, csv, x, k);
  }
  return head(name,
              report.runs.size() + 1,
              csv,
              x,
              label,
              "velocity error, relative {/:Italic L}_2") +
         value_axis(csv, 4, 2, csv.columns.size()) + "plot " + parts + "\n";
}

}  // namespace

FigureGroup time_figures(const Report& report) {
  FigureGroup group;
  const auto usable = [](const TimeErrorPoint& point) { return point.failure.empty(); };
  if (std::count_if(report.error_against_time.begin(), report.error_against_time.end(), usable) <
      2) {
    return group;
  }
  const Csv csv = error_csv(report);
  group.data[data_file] = csv;
  group.figures.push_back(
      {.name = "error_law_time",
       .script = law_script("error_law_time", csv),
       .label = "Error of the law against DEM averaging time",
       .caption = "Law: largest difference of <i>I</i>(<i>θ</i>) from the fit to all "
                  "data, which shares their data, and the standard error each fit claims"_html});
  if (guide(csv, 0, 4, 2).empty()) return group;  // no profile to compare
  group.figures.push_back({.name = "error_profile_time",
                           .script = profile_script(report, "error_profile_time", csv, 0),
                           .label = "Error of predicted profiles against DEM averaging time",
                           .caption = "Predicted profiles, run by run"_html});
  group.figures.push_back({.name = "error_profile_wall",
                           .script = profile_script(report, "error_profile_wall", csv, 1),
                           .label = "Error of predicted profiles against DEM wall time",
                           .caption = "Same against the wall time of the fitted DEM runs, start-up "
                                      "included"_html});
  return group;
}

}  // namespace grainlaw::report
