#include "apps/study_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/summary.h"

namespace grainlaw::study {
namespace {

std::vector<std::string> distinct(const std::vector<Point>& points, std::string Point::*name) {
  std::vector<std::string> names;
  for (const Point& point : points) {
    if (std::ranges::find(names, point.*name) == names.end()) names.push_back(point.*name);
  }
  return names;
}

bool has_bar(const Point& point) {
  return std::isfinite(point.error_bar) && point.error_bar > 0.0;
}

double bar(const Point& point) {
  return has_bar(point) ? point.error_bar : 0.0;
}

/// The series is part of the name where a quantity has several.
std::string setting_text(const Point& point) {
  return point.series == point.quantity ? point.setting : point.series + ", " + point.setting;
}

/// "5.8 us CPU" reads easier than 5.8e-06 CPU s.
std::string cost_text(const Point& point, const std::string& unit) {
  if (unit == "CPU s" && point.cost < 1e-3) return fmt::format("{:.3g} us CPU", 1e6 * point.cost);
  if (unit == "CPU s" && point.cost < 1.0) return fmt::format("{:.3g} ms CPU", 1e3 * point.cost);
  return fmt::format("{:.3g} {}", point.cost, unit);
}

template <class Reaches>
const Point* cheapest(const std::vector<const Point*>& points, const Reaches& reaches) {
  const Point* best = nullptr;
  for (const Point* point : points) {
    if (reaches(*point) && (best == nullptr || point->cost < best->cost)) best = point;
  }
  return best;
}

std::string advise_on(const std::string& quantity,
                      const std::vector<const Point*>& points,
                      double accuracy,
                      const std::string& unit) {
  const std::string goal = fmt::format("{:g} % in {}", 100.0 * accuracy, quantity);
  if (points.empty()) return fmt::format("{}: no setting gave a result.", quantity);
  const auto surely = [&](const Point& p) { return p.error + 2.0 * bar(p) <= accuracy; };
  if (const Point* best = cheapest(points, surely)) {
    return fmt::format("For {} use {} ({}; error {}).",
                       goal,
                       setting_text(*best),
                       cost_text(*best, unit),
                       error_text(*best));
  }
  const auto perhaps = [&](const Point& p) { return p.error <= std::max(accuracy, 2.0 * bar(p)); };
  if (const Point* best = cheapest(points, perhaps)) {
    return fmt::format(
        "These runs are too short to tell whether {} is reached: the cheapest setting that may "
        "reach it, {} ({}), is off by {}.",
        goal,
        setting_text(*best),
        cost_text(*best, unit),
        error_text(*best));
  }
  const Point& best = **std::ranges::min_element(
      points, [](const Point* a, const Point* b) { return a->error < b->error; });
  return fmt::format("No setting reaches {}: the best, {} ({}), is off by {}.",
                     goal,
                     setting_text(best),
                     cost_text(best, unit),
                     error_text(best));
}

}  // namespace

std::vector<std::string> quantities(const std::vector<Point>& points) {
  return distinct(points, &Point::quantity);
}

std::vector<std::string> series(const std::vector<Point>& points) {
  return distinct(points, &Point::series);
}

std::vector<std::string> advise(const std::vector<Point>& points,
                                double accuracy,
                                const std::string& cost_unit) {
  std::vector<std::string> advice;
  for (const std::string& quantity : quantities(points)) {
    std::vector<const Point*> usable;
    for (const Point& point : points) {
      const bool counts = point.quantity == quantity && !point.failed();
      if (counts && std::isfinite(point.error)) usable.push_back(&point);
    }
    advice.push_back(advise_on(quantity, usable, accuracy, cost_unit));
  }
  return advice;
}

std::string error_text(double error) {
  if (!(error >= 1e-4)) return fmt::format("{:.1e}", error);
  // two digits, a zero among them: 4.0 %, 12 %
  const double percent = 100.0 * error;
  const std::string rounded = fmt::format("{:.1e}", percent);
  const int power = std::stoi(rounded.substr(rounded.find('e') + 1));
  return fmt::format("{:.{}f} %", percent, std::max(0, 1 - power));
}

std::string error_text(const Point& point) {
  if (!has_bar(point)) return error_text(point.error);
  return value_with_error(100.0 * point.error, 100.0 * point.error_bar) + " %";
}

}  // namespace grainlaw::study
