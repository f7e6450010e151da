#pragma once

#include <string>

#include "dem/estimate.h"

namespace grainlaw::report {

/// Number as text with the given significant digits, as 1.23 × 10⁻⁵ where it is very small or
/// large. NaN and infinity, which mean "not there", become a dash.
std::string significant(double value, int digits = 3);

/// Number with the given decimals; negative ones round to tens, hundreds, ...
std::string fixed(double value, int decimals);

/// "0.041 to 0.206"; one number where both ends read the same.
std::string interval(double lower, double upper);

/// "0.3672 ± 0.0021": value rounded to the second digit of its standard error. Without an error
/// the value with 4 digits.
std::string with_error(const dem::Estimate& estimate);

/// "0.564 ± 0.027 [0.484, 0.651]", the ends to the decimal of the error; no brackets where the
/// upper end has no limit.
std::string with_interval(const dem::Estimate& estimate, double lower, double upper);

/// A ratio in percent, "3.12 ± 0.41 %".
std::string percent(const dem::Estimate& ratio);
/// Same without the sign, for table columns that carry it in the head.
std::string percent_value(const dem::Estimate& ratio);

/// An angle in radians as "24.8°".
std::string degrees(double radians);

/// A wall time as "7.2 µs", "38 ms", "12.3 s", "6 min 40 s" or "2 h 05 min".
std::string duration(double seconds);

/// " × 10⁻⁵"
std::string power_of_ten(int power);

/// A number that somebody chose, as 2 × 10⁵.
std::string power_text(double value);

/// A whole number with thin spaces between thousands.
std::string count(double number);

dem::Estimate scaled(const dem::Estimate& estimate, double factor);

}  // namespace grainlaw::report
