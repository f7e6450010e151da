#include "apps/report/figure.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

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
    const bool special = std::string_view("'\"`\\_^{}@&~%,\n\r").find(c) != std::string_view::npos;
    result += special ? ' ' : c;
  }
  return result;
}

std::string plot_head(const std::string& name, PlotSize size) {
  return fmt::format(R"(# Draws {0}.svg from the CSV files beside it: gnuplot {0}.gp
set terminal svg size {1},{2} dynamic enhanced font ',12'
set output '{0}.svg'
set encoding utf8
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
  std::string tics;
  for (double decade = 1e-6; decade < 1e7; decade *= 10.0) {
    for (const double digit : digits) {
      tics += fmt::format("{}{:.3g}", tics.empty() ? "" : ", ", digit * decade);
    }
  }
  return fmt::format(
      "set {0}range [{1:.4g}:{2:.4g}]\nset {0}tics ({3})\n", axis, lower, upper, tics);
}

std::string point_style(std::size_t k) {
  const SeriesStyle& style = series[k % series.size()];
  return fmt::format("pt {} ps 0.5 lc rgb '{}'", style.point, style.colour);
}

std::string hollow_style(std::size_t k) {
  const SeriesStyle& style = series[k % series.size()];
  return fmt::format("pt {} ps 0.6 lc rgb '{}'", style.point - 1, style.colour);
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
