#pragma once

#include <cmath>
#include <functional>

namespace grainlaw::continuum {

/// Two numbers between which something changes, and by how much they miss it: negative at `low`,
/// positive at `high`; infinite where there is only a side and no number.
struct Bracket {
  double low = 0.0;
  double high = 0.0;
  double low_miss = -HUGE_VAL;
  double high_miss = HUGE_VAL;

  /// The end that misses less; where neither has a number, the lower one if it was ever tried.
  double nearest() const;
};

/// Closes in on the root of an increasing function, known between the ends of the bracket, which
/// are not evaluated: regula falsi (Illinois) where both ends have numbers, else halving, down to
/// |miss| <= 1e-13 or neighbouring numbers.
Bracket root(const std::function<double(double)>& miss, Bracket bracket);

/// Halves the way from `yes`, where the condition holds, to `no`, where it does not, down to
/// `precision` of it; low is the last number at which it holds, high the first at which it does
/// not.
Bracket split(const std::function<bool(double)>& holds,
              double yes,
              double no,
              double precision = 1e-12);

/// Where a function with one maximum between the ends has it, to 1e-8 of their distance; ends
/// earlier at a value that is `enough`.
double golden_section(const std::function<double(double)>& value,
                      double low,
                      double high,
                      double enough);

}  // namespace grainlaw::continuum
