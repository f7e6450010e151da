#pragma once

#include <limits>
#include <string>
#include <vector>

namespace grainlaw::study {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One setting, what it cost and how far off its result is.
struct Point {
  std::string quantity;      ///< what is off: "mu", "velocity"
  std::string series;        ///< line of the figure it belongs to
  std::string setting;       ///< short label beside the point: "t/20", "200 cells"
  double cost = nan;         ///< where it stands on the axis: CPU seconds unless said otherwise
  double cpu_seconds = nan;  ///< of everything this result needed
  double wall_seconds = nan;
  double error = nan;        ///< relative; NaN: none can be told
  double error_bar = nan;    ///< standard error of it; NaN: not known, or none
  std::string failure = {};  ///< not empty: why there is no error
  std::string mark = {};     ///< shorter setting for the figure; empty: as it is

  bool failed() const { return !failure.empty(); }
};

/// What a study found.
struct Result {
  std::string title;
  std::string kind;
  std::string machine;
  std::string reference;                       ///< what errors are against, a sentence
  std::string cost_label = "CPU time [s]";     ///< of the figure
  std::string error_label = "relative error";  ///< of the figure
  bool ordered = true;  ///< points of a series follow each other: a line joins them
  std::vector<Point> points;
  std::vector<std::string> remarks;  ///< sentences a reader must know
  std::vector<std::string> advice;   ///< what to choose, a sentence for each quantity
};

/// For each quantity the cheapest setting that reaches the accuracy: surely (error plus two
/// standard errors), or as far as its error bar can tell; or that none does.
std::vector<std::string> advise(const std::vector<Point>& points,
                                double accuracy,
                                const std::string& cost_unit = "CPU s");

/// The quantities in the order of their first points.
std::vector<std::string> quantities(const std::vector<Point>& points);

/// The series likewise.
std::vector<std::string> series(const std::vector<Point>& points);

/// "1.2 %", "3e-07".
std::string error_text(double error);

/// "0.8 +- 0.3 %"; without an error bar error_text.
std::string error_text(const Point& point);

}  // namespace grainlaw::study
