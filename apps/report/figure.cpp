#include "apps/report/figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <vector>

#include "apps/report/numbers.h"

namespace grainlaw::report {
namespace {

struct SeriesStyle {
  int point = 0;
  std::string_view dash;
  std::string_view colour;
};

// Shapes and dashes differ as well, so that a figure can be read without its colours.
constexpr std::array<SeriesStyle, 5> series = {{{7, "1", colour::measured},
                                                {5, "(12,4)", colour::predicted},
                                                {9, "(6,3,2,3)", colour::third},
                                                {13, "(2,3)", colour::fourth},
                                                {11, "(9,3,2,3,2,3)", colour::band}}};

}  // namespace

std::string run_title(const RunComparison& run) {
  const std::string tilt = degrees(run.data.conditions.inclination);
  if (run.kind == calibration::SampleKind::in_sample) return tilt + ", in sample";
  return fmt::format("{}, predicted ({})", tilt, calibration::name(run.kind));
}

std::string file_stem(const RunComparison& run, std::size_t number) {
  std::string result = std::to_string(number) + '_';
  for (const char c : run.data.name) {
    const bool keep = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (keep) result += c;
    if (!keep && result.back() != '_') result += '_';
  }
  if (result.back() == '_') result.pop_back();
  return result;
}

std::string plot_text(std::string_view name) {
  std::string result;
  for (const char c : name) {
    const bool special = std::string_view("'\"`\\^{}@&~%\n\r").find(c) != std::string_view::npos;
    if (c == '_') result += '\\';
    result += special ? ' ' : c;
  }
  return result;
}

std::string plot_head(const std::string& name, PlotSize size) {
  return fmt::format(R"(# Draws {0}.svg from the CSV files beside it: gnuplot {0}.gp
set terminal svg size {1},{2} dynamic enhanced font ',12'
set output '{0}.svg'
set encoding utf8
set minussign
set datafile separator comma
set datafile columnheaders
set lmargin at screen {3:.3f}
set rmargin at screen 0.97
set bmargin at screen {4:.3f}
set tmargin at screen {5:.3f}
set border 3
set tics nomirror out scale 0.5
set xtics offset 0,0.3
set ytics offset 0.4,0
set xlabel offset 0,0.6
set ylabel offset 0.7,0
set format '%g'
set errorbars 0
set key at screen {3:.3f},0.99 left top Left reverse horizontal samplen 1.6 width -1
)",
                     name,
                     size.width,
                     size.height,
                     70.0 / size.width,
                     52.0 / size.height,
                     1.0 - 46.0 / size.height);
}

std::string key_room(std::size_t entries) {
  const double rows = std::ceil(static_cast<double>(entries) / 2.0);
  const double room = std::max(46.0, 14.0 + 18.0 * rows);
  return fmt::format("set tmargin at screen {:.3f}\n", 1.0 - room / PlotSize{}.height);
}

std::string law_title(const Report& report, std::size_t table, const char* law) {
  return report.tables.size() > 1 ? fmt::format("{} {}", table + 1, law) : std::string(law);
}

std::string log_axis(char axis, double lower, double upper) {
  const double span = upper / lower;
  const std::vector<double> digits = span < 6.0    ? std::vector{1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0}
                                     : span < 60.0 ? std::vector{1.0, 2.0, 5.0}
                                                   : std::vector{1.0};
  return fmt::format(
      "set {0}range [{1:.4g}:{2:.4g}]\nset {0}tics ({3})\n", axis, lower, upper, log_tics(digits));
}

std::string log_tics(const std::vector<double>& digits) {
  std::string tics;
  for (int power = -12; power < 12; ++power) {
    for (const double digit : digits) {
      const double at = digit * std::pow(10.0, power);
      const std::string label = power < -4 || power > 4 ? fmt::format("'10^{{{}}}' ", power) : "";
      if (label.empty() || digit == 1.0)
        tics += fmt::format("{}{}{:.3g}", tics.empty() ? "" : ", ", label, at);
    }
    for (int digit = 2; digit < 10; ++digit) {  // without a label
      tics += fmt::format(", '' {}e{} 1", digit, power);
    }
  }
  return tics;
}

std::string key_above(std::size_t entries, std::size_t longest_title, PlotSize size) {
  // What gnuplot reserves: a letter 7 px, the sample 40.
  const double column = 7.2 * static_cast<double>(longest_title) + 40.0;
  const std::size_t columns = 2.0 * column < size.width - 80.0 ? 2 : 1;
  const std::size_t rows = (entries + columns - 1) / columns;
  return fmt::format("set key maxcols {}\nset tmargin at screen {:.3f}\n",
                     columns,
                     1.0 - (18.0 * static_cast<double>(rows) + 12.0) / size.height);
}

std::size_t longest(const std::vector<std::string>& titles) {
  std::size_t result = 0;
  for (const std::string& title : titles) result = std::max(result, title.size());
  return result;
}

std::string point_style(std::size_t k, double size) {
  const SeriesStyle& style = series[k % series.size()];
  return fmt::format("pt {} ps {} lc rgb '{}'", style.point, size, style.colour);
}

std::string hollow_style(std::size_t k, double size) {
  const SeriesStyle& style = series[k % series.size()];
  return fmt::format("pt {} ps {} lc rgb '{}'", style.point - 1, size, style.colour);
}

std::string line_style(std::size_t k) {
  const SeriesStyle& style = series[k % series.size()];
  return fmt::format("dt {} lw 1.5 lc rgb '{}'", style.dash, style.colour);
}

Scales scales(const dem::ChuteConditions& conditions) {
  const double d = conditions.grain_diameter;
  const double g = conditions.gravity;
  return {.length = d, .velocity = std::sqrt(g * d), .time = std::sqrt(d / g)};
}

}  // namespace grainlaw::report
