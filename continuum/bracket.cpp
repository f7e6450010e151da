#include "continuum/bracket.h"

#include <cmath>
#include <numbers>

namespace grainlaw::continuum {
namespace {

constexpr double close_enough = 1e-13;
constexpr int most_steps = 300;

/// Where the straight line between the ends crosses zero; the middle where an end has no number or
/// the line would hardly move.
double guess(const Bracket& b) {
  const double middle = b.low + 0.5 * (b.high - b.low);
  if (!std::isfinite(b.low_miss) || !std::isfinite(b.high_miss)) return middle;
  const double crossing = b.low - b.low_miss * (b.high - b.low) / (b.high_miss - b.low_miss);
  return crossing > b.low && crossing < b.high ? crossing : middle;
}

}  // namespace

double Bracket::nearest() const {
  if (std::isinf(low_miss) && std::isinf(high_miss)) return 0.5 * (low + high);
  return -low_miss <= high_miss ? low : high;
}

Bracket root(const std::function<double(double)>& miss, Bracket bracket) {
  Bracket weighted = bracket;  // Illinois: an end that stays counts half
  int stayed = 0;              // > 0: steps that the low end stayed, < 0: the high one
  for (int step = 0; step < most_steps; ++step) {
    const double middle = bracket.low + 0.5 * (bracket.high - bracket.low);
    const double x = step % 4 == 3 ? middle : guess(weighted);
    if (x <= bracket.low || x >= bracket.high) break;
    const double f = miss(x);
    if (f > 0.0) {
      bracket.high = weighted.high = x;
      bracket.high_miss = weighted.high_miss = f;
      stayed = stayed > 0 ? stayed + 1 : 1;
      if (stayed > 1) weighted.low_miss *= 0.5;
      if (stayed == 1) weighted.low_miss = bracket.low_miss;
    } else {
      bracket.low = weighted.low = x;
      bracket.low_miss = weighted.low_miss = f;
      stayed = stayed < 0 ? stayed - 1 : -1;
      if (stayed < -1) weighted.high_miss *= 0.5;
      if (stayed == -1) weighted.high_miss = bracket.high_miss;
    }
    if (std::abs(f) <= close_enough) break;
  }
  return bracket;
}

Bracket split(const std::function<bool(double)>& holds, double yes, double no, double precision) {
  const double smallest = precision * std::abs(no - yes);
  while (std::abs(no - yes) > smallest) {
    const double middle = 0.5 * (yes + no);
    if (middle == yes || middle == no) break;
    (holds(middle) ? yes : no) = middle;
  }
  return {.low = yes, .high = no};
}

double golden_section(const std::function<double(double)>& value,
                      double low,
                      double high,
                      double enough) {
  constexpr double ratio = 1.0 / std::numbers::phi;
  const double smallest = 1e-8 * (high - low);
  double left = high - ratio * (high - low);
  double right = low + ratio * (high - low);
  double at_left = value(left);
  double at_right = value(right);
  while (high - low > smallest) {
    if (at_left >= enough) return left;
    if (at_right >= enough) return right;
    if (at_left >= at_right) {
      high = right;
      right = left;
      at_right = at_left;
      at_left = value(left = high - ratio * (high - low));
    } else {
      low = left;
      left = right;
      at_left = at_right;
      at_right = value(right = low + ratio * (high - low));
    }
  }
  return 0.5 * (low + high);
}

}  // namespace grainlaw::continuum
