#include "apps/report/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace grainlaw::report {
namespace {

constexpr std::string_view absent = "–";

/// Beyond these powers of ten a number is easier to read with its power written out.
constexpr int smallest_plain_power = -4;
constexpr int largest_plain_power = 5;

std::string with_minus_sign(const std::string& number) {
  return number.starts_with('-') ? "−" + number.substr(1) : number;
}

/// Power of ten of the first digit after rounding to `digits` (0.0996 to 2 digits: -1).
int leading_power(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", std::abs(value), digits - 1);
  return std::stoi(text.substr(text.find('e') + 1));
}

bool is_plain(int power) {
  return power >= smallest_plain_power && power <= largest_plain_power;
}

}  // namespace

std::string power_of_ten(int power) {
  constexpr std::array<std::string_view, 10> raised = {
      "⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string result = power < 0 ? " × 10⁻" : " × 10";
  for (const char digit : std::to_string(std::abs(power))) {
    result += raised[static_cast<std::size_t>(digit - '0')];
  }
  return result;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return std::string(absent);
  const double unit = std::pow(10.0, -decimals);  // decimals < 0: round to tens, hundreds
  const double rounded = decimals < 0 ? std::round(value / unit) * unit : value;
  return with_minus_sign(fmt::format("{:.{}f}", rounded, std::max(0, decimals)));
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return std::string(absent);
  if (value == 0.0) return "0";
  const int power = leading_power(value, digits);
  if (is_plain(power)) return fixed(value, digits - 1 - power);
  return fixed(value / std::pow(10.0, power), digits - 1) + power_of_ten(power);
}

std::string interval(double lower, double upper) {
  const std::string first = significant(lower, 3);
  const std::string last = significant(upper, 3);
  return first == last ? first : first + " to " + last;
}

std::string with_error(const dem::Estimate& estimate) {
  const double value = estimate.value;
  const double error = estimate.error;
  if (!std::isfinite(value)) return std::string(absent);
  if (!std::isfinite(error) || error <= 0.0) return significant(value, 4);
  const int error_power = leading_power(error, 2);
  const int power = std::max(error_power, value == 0.0 ? error_power : leading_power(value, 2));
  if (is_plain(power) && error_power >= smallest_plain_power - 1) {
    const int decimals = 1 - error_power;
    return fixed(value, decimals) + " ± " + fixed(error, decimals);
  }
  const double unit = std::pow(10.0, power);
  const int decimals = 1 - error_power + power;
  return fmt::format("({} ± {}){}",
                     fixed(value / unit, decimals),
                     fixed(error / unit, decimals),
                     power_of_ten(power));
}

std::string percent_value(const dem::Estimate& ratio) {
  if (std::isfinite(ratio.error) && ratio.error > 0.0) return with_error(scaled(ratio, 100.0));
  return significant(100.0 * ratio.value, 3);
}

std::string percent(const dem::Estimate& ratio) {
  return std::isfinite(ratio.value) ? percent_value(ratio) + " %" : std::string(absent);
}

std::string degrees(double radians) {
  if (!std::isfinite(radians)) return std::string(absent);
  const double rounded = std::round(radians * 180.0 / std::numbers::pi * 100.0) / 100.0;
  const bool one_decimal = std::abs(10.0 * rounded - std::round(10.0 * rounded)) < 1e-6;
  return with_minus_sign(fmt::format("{:.{}f}°", rounded, one_decimal ? 1 : 2));
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return std::string(absent);
  if (seconds > 0.0 && seconds < 1e-3) return significant(1e6 * seconds, 2) + " µs";
  if (seconds < 1.0) return significant(1000.0 * seconds, 2) + " ms";
  if (seconds < 60.0) return significant(seconds, 3) + " s";
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string count(double number) {
  if (!std::isfinite(number)) return std::string(absent);
  std::string digits = fmt::format("{:.0f}", std::abs(number));
  for (std::size_t end = digits.size(); end > 3; end -= 3) digits.insert(end - 3, "\u202f");
  return number < 0.0 ? "−" + digits : digits;
}

dem::Estimate scaled(const dem::Estimate& estimate, double factor) {
  return {.value = factor * estimate.value, .error = std::abs(factor) * estimate.error};
}

}  // namespace grainlaw::report
