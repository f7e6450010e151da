#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "apps/report/figure.h"
#include "apps/report/typeset.h"
#include "apps/study_report.h"

namespace grainlaw::study {
namespace {

/// Shape, dash and colour of a line: shapes alone tell sixteen apart, without colours.
struct Style {
  int point;
  std::string_view dash;
  std::string_view colour;
};

Style style(std::size_t k) {
  constexpr std::array<int, 10> shapes = {7, 4, 9, 12, 5, 6, 11, 8, 13, 10};
  constexpr std::array<std::string_view, 4> dashes = {"1", "(12,4)", "(6,3,2,3)", "(2,3)"};
  constexpr std::array<std::string_view, 4> colours = {report::colour::measured,
                                                       report::colour::predicted,
                                                       report::colour::third,
                                                       report::colour::fourth};
  return {shapes[k % shapes.size()], dashes[(k + k / 4) % dashes.size()], colours[k % 4]};
}

/// Errors at rounding would only stretch the axis; a logarithmic one has no place for zero.
bool drawable(const Point& point) {
  constexpr double rounding = 1e-12;
  return !point.failed() && point.error > rounding && point.cost > 0.0;
}

std::string mark(const Point& point) {
  return point.mark.empty() ? point.setting : point.mark;
}

/// As a field of a data block.
std::string mark_field(const Point& point) {
  std::string text = report::plot_symbol(report::typeset(mark(point)));
  std::ranges::replace(text, ',', ' ');
  return text;
}

struct Axis {
  double lower = 0.1;
  double upper = 1.0;

  void include(double value) {
    if (!(value > 0.0) || !std::isfinite(value)) return;  // has no place on it
    lower = empty ? value : std::min(lower, value);
    upper = empty ? value : std::max(upper, value);
    empty = false;
  }
  bool empty = true;
};

Axis cost_axis(const Result& result) {
  Axis axis;
  for (const Point& point : result.points) {
    if (drawable(point) || point.failed()) axis.include(point.cost);
  }
  return {.lower = 0.6 * axis.lower, .upper = 2.0 * axis.upper, .empty = axis.empty};
}

Axis error_axis(const Result& result) {
  Axis axis;
  for (const Point& point : result.points) {
    if (!drawable(point)) continue;
    axis.include(point.error);
    axis.include(point.error + point.error_bar);
  }
  return {.lower = 0.4 * axis.lower, .upper = 4.0 * axis.upper, .empty = axis.empty};
}

/// Labels of the axis close enough for its span: gnuplot labels powers of ten only.
std::string range_and_tics(char name, const Axis& axis) {
  std::string text = fmt::format("set {}range [{:.10g}:{:.10g}]\n", name, axis.lower, axis.upper);
  const double decades = std::log10(axis.upper / axis.lower);
  if (decades > 2.5) {
    const double step = std::pow(10.0, std::ceil(decades / 8.0));
    return text + fmt::format("set {0}tics {1:g}\nset format {0} '10^{{%T}}'\n", name, step);
  }
  const std::vector<double> digits =
      decades < 1.2 ? std::vector{1.0, 1.5, 2.0, 3.0, 5.0, 7.0} : std::vector{1.0, 2.0, 5.0};
  return text + fmt::format("set {}tics ({})\n", name, report::log_tics(digits));
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.10g}", value) : std::string{};
}

/// A block of the points of one series that have a place in the figure. Error bars end at the axis.
std::string data_block(const Result& result,
                       std::size_t k,
                       const Axis& axis,
                       const std::string& name) {
  std::string text = fmt::format("$series{} << END\ncost,error,low,high\n", k);
  for (const Point& point : result.points) {
    if (point.series != name || !drawable(point)) continue;
    const double bar = std::isfinite(point.error_bar) ? point.error_bar : 0.0;
    text += fmt::format("{},{},{},{}\n",
                        number(point.cost),
                        number(point.error),
                        number(std::max(point.error - bar, axis.lower)),
                        number(point.error + bar));
  }
  return text + "END\n";
}

constexpr int figure_width = 720, figure_height = 460;                  // pixels
constexpr double left = 0.11, right = 0.70, bottom = 0.12, top = 0.92;  // of the frame, shares

/// Puts texts beside points so that none lies on another or on a point.
class LabelPlacer {
 public:
  LabelPlacer(const Axis& x, const Axis& y) : x_(x), y_(y) {}

  void avoid(double x, double y) { taken_.push_back({across(x), up(y), 5.0, 5.0}); }

  /// Middle of the text, in the numbers of the axes; none where every place is taken.
  std::optional<std::pair<double, double>> place(double x, double y, const std::string& text) {
    const double width = 2.8 * static_cast<double>(text.size()) + 3.0;  // half of it
    constexpr double height = 5.5;
    const double aside = width + 6.0;
    const std::array<std::pair<double, double>, 6> shifts = {
        {{0, 11}, {0, -12}, {aside, 3}, {-aside, 3}, {aside, 11}, {aside, -11}}};
    for (const auto& [dx, dy] : shifts) {
      const Box box{across(x) + dx, up(y) + dy, width, height};
      if (std::ranges::any_of(taken_, [&](const Box& other) { return overlap(box, other); })) {
        continue;
      }
      taken_.push_back(box);
      return std::pair{x * std::pow(x_.upper / x_.lower, dx / frame_width()),
                       y * std::pow(y_.upper / y_.lower, dy / frame_height())};
    }
    return std::nullopt;
  }

 private:
  struct Box {
    double x, y, half_width, half_height;  // pixels
  };
  static bool overlap(const Box& a, const Box& b) {
    return std::abs(a.x - b.x) < a.half_width + b.half_width &&
           std::abs(a.y - b.y) < a.half_height + b.half_height;
  }
  static double frame_width() { return (right - left) * figure_width; }
  static double frame_height() { return (top - bottom) * figure_height; }
  double across(double x) const {
    return frame_width() * std::log(x / x_.lower) / std::log(x_.upper / x_.lower);
  }
  double up(double y) const {
    return frame_height() * std::log(y / y_.lower) / std::log(y_.upper / y_.lower);
  }

  Axis x_, y_;
  std::vector<Box> taken_;
};

/// One label for all points of a setting that stand above each other, at the highest.
std::string label_block(const Result& result, const Axis& cost, const Axis& error) {
  std::string text = "$labels << END\ncost,error,label\n";
  LabelPlacer placer(cost, error);
  std::vector<const Point*> points;
  for (const Point& point : result.points) {
    if (!drawable(point)) continue;
    points.push_back(&point);
    placer.avoid(point.cost, point.error);
  }
  std::ranges::stable_sort(points, std::ranges::greater(), &Point::error);
  std::set<std::pair<std::string, double>> done;
  for (const Point* point : points) {
    if (!done.insert({point->setting, point->cost}).second) continue;
    const auto at = placer.place(point->cost, point->error, mark(*point));
    if (at)
      text += fmt::format("{},{},{}\n", number(at->first), number(at->second), mark_field(*point));
  }
  return text + "END\n";
}

/// Failures on the top edge; those that cost nothing side by side from its left end.
std::string failure_block(const Result& result, const Axis& cost, const Axis& error) {
  std::string text;
  std::set<std::pair<std::string, double>> done;
  double across = 0.0;                              // pixels
  std::vector<std::pair<double, double>> labelled;  // middle and half width of their labels
  for (const Point& point : result.points) {
    const bool free = !(point.cost > 0.0);
    if (!point.failed() || !done.insert({point.setting, free ? 0.0 : point.cost}).second) continue;
    const double half_label = 2.8 * static_cast<double>(mark(point).size()) + 5.0;
    const double width = (right - left) * figure_width;
    const double log_span = std::log(cost.upper / cost.lower);
    if (free) across += half_label;
    const double at = free ? cost.lower * std::exp(log_span * across / width) : point.cost;
    if (free) across += half_label;
    const double place = width * std::log(at / cost.lower) / log_span;
    const bool covered = std::ranges::any_of(labelled, [&](const std::pair<double, double>& other) {
      return std::abs(other.first - place) < other.second + half_label - 5.0;
    });
    if (!covered) labelled.emplace_back(place, half_label);
    text += fmt::format(
        "{},{},{}\n", number(at), number(0.9999 * error.upper), covered ? " " : mark_field(point));
  }
  return text.empty() ? text : "$failures << END\ncost,error,label\n" + text + "END\n";
}

std::string series_part(std::size_t k, const std::string& name, bool joined) {
  const Style look = style(k);
  const std::string colour = fmt::format("lc rgb '{}'", look.colour);
  return fmt::format(
      "$series{0} using 1:2:3:4 with yerrorbars pt {1} ps 0.1 lw 1 {2} notitle, \\\n     "
      "$series{0} using 1:2 with {5} pt {1} ps 0.6 {3} {2} title '{4}'",
      k,
      look.point,
      colour,
      joined ? fmt::format("dt {} lw 1.3", look.dash) : std::string(),
      report::plot_symbol(report::typeset(name)),
      joined ? "linespoints" : "points");
}

/// Series that have a point in the figure.
std::vector<std::string> drawn_series(const Result& result) {
  std::vector<std::string> names;
  for (const std::string& name : series(result.points)) {
    const auto drawn = [&](const Point& point) { return point.series == name && drawable(point); };
    if (std::ranges::any_of(result.points, drawn)) names.push_back(name);
  }
  return names;
}

}  // namespace

std::string plot_script(const Result& result) {
  const Axis cost = cost_axis(result);
  const Axis error = error_axis(result);
  const std::string failures = failure_block(result, cost, error);
  const std::vector<std::string> names = drawn_series(result);
  std::string data = label_block(result, cost, error) + failures;
  std::string parts;
  for (std::size_t k = 0; k < names.size(); ++k) {
    data += data_block(result, k, error, names[k]);
    parts += series_part(k, names[k], result.ordered) + ", \\\n     ";
  }
  parts += "$labels using 1:2:3 with labels font ',9' notitle";
  if (!failures.empty()) {
    parts +=
        ", \\\n     $failures using 1:2 with points pt 2 ps 1 lw 2 lc rgb 'black' title 'no "
        "result', \\\n     $failures using 1:2:3 with labels offset 0,0.8 font ',9' notitle";
  }
  return report::plot_head("study", {.width = figure_width, .height = figure_height}) +
         fmt::format(
             "set lmargin at screen {}\nset rmargin at screen {}\n"
             "set bmargin at screen {}\nset tmargin at screen {}\n",
             left,
             right,
             bottom,
             top) +
         "set key at screen 0.72,0.92 left top Left reverse vertical samplen 3 width 0 font ',10'\n"
         "set logscale xy\nset errorbars small\n" +
         range_and_tics('x', cost) + range_and_tics('y', error) +
         fmt::format("set xlabel '{}'\nset ylabel '{}' offset -0.5,0\n",
                     report::plot_symbol(report::typeset(result.cost_label)),
                     report::plot_symbol(report::typeset(result.error_label))) +
         data + "plot " + parts + "\n";
}

}  // namespace grainlaw::study
