#include "apps/report/numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "dem/estimate_text.h"

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
  if (lower < 0.0 && upper > 0.0) {  // about 0: both ends to the same decimal
    const int power = leading_power(std::max(-lower, upper), 3);
    if (is_plain(power)) return fixed(lower, 2 - power) + " to " + fixed(upper, 2 - power);
  }
  const std::string first = significant(lower, 3);
  const std::string last = significant(upper, 3);
  return first == last ? first : first + " to " + last;
}

std::string with_error(const dem::Estimate& estimate) {
  if (!std::isfinite(estimate.value)) return std::string(absent);
  if (!std::isfinite(estimate.error) || estimate.error <= 0.0) {
    return significant(estimate.value, 4);
  }
  std::string plain = value_with_error(estimate.value, estimate.error);
  plain.replace(plain.find("+-"), 2, "±");
  if (plain.front() == '-') plain.replace(0, 1, "−");
  if (plain.starts_with("(-")) plain.replace(1, 1, "−");
  const std::size_t power = plain.find(")e");
  if (power == std::string::npos) return plain;
  return plain.substr(0, power + 1) + power_of_ten(std::stoi(plain.substr(power + 2)));
}

std::string with_interval(const dem::Estimate& estimate, double lower, double upper) {
  const std::string number = with_error(estimate);
  if (!std::isfinite(estimate.value) || !std::isfinite(upper)) return number;
  const bool scaled = number.find("×") != std::string::npos;
  const auto end = [&](double x) {
    if (x == 0.0) return std::string("0");
    if (scaled || !(estimate.error > 0.0)) return significant(x, 2);
    return fixed(x, 1 - leading_power(estimate.error, 2));
  };
  return fmt::format("{} [{}, {}]", number, end(lower), end(upper));
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

std::string power_text(double value) {
  const int power = leading_power(value, 6);
  const std::string factor = with_minus_sign(fmt::format("{:.6g}", value / std::pow(10.0, power)));
  const std::string times = power_of_ten(power);
  return factor == "1" ? times.substr(times.find("10")) : factor + times;
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
