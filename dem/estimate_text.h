#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace grainlaw {  // of all programs: those without DEM have no symbol of grainlaw::dem

/// The one way in which a value is written beside its error, in plain text: "0.310 +- 0.063": value
/// and error to the same decimal, the second digit of the error;
/// "(3.19 +- 0.24)e-07" where both are very small or very large. Without an error six digits.
inline std::string value_with_error(double value, double error) {
  char buffer[64];
  const auto print = [&](const char* format, auto... numbers) {
    std::snprintf(buffer, sizeof buffer, format, numbers...);
    return std::string(buffer);
  };
  if (!std::isfinite(value)) return "not measured";
  if (!std::isfinite(error) || error <= 0.0) return print("%.6g", value);
  /// Of the first digit, after rounding to two.
  const auto power_of = [&](double number) {
    const std::string text = print("%.1e", number);
    return std::atoi(text.c_str() + text.find('e') + 1);
  };
  const int of_error = power_of(error);
  const int power = value == 0.0 ? of_error : std::max(of_error, power_of(value));
  const bool plain = power >= -4 && power <= 5;
  const double unit = plain ? 1.0 : std::pow(10.0, power);
  const int decimals = std::min(15, 1 - of_error + (plain ? 0 : power));
  const double step = decimals < 0 ? std::pow(10.0, -decimals) : 1.0;  // round to tens, hundreds
  const auto rounded = [&](double x) { return decimals < 0 ? std::round(x / step) * step : x; };
  const int shown = std::max(0, decimals);
  const double v = rounded(value / unit);
  const double e = rounded(error / unit);
  if (plain) return print("%.*f +- %.*f", shown, v, shown, e);
  return print("(%.*f +- %.*f)e%+03d", shown, v, shown, e, power);
}

}  // namespace grainlaw
