#include "calibration/model_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dem/statistics.h"

namespace grainlaw::calibration {
namespace {

/// Continued fraction of the incomplete beta function by Lentz' method (Abramowitz and Stegun,
/// 26.5.8); converges fast for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  constexpr int most_terms = 10000;
  const auto guarded = [](double v) { return std::abs(v) < tiny ? tiny : v; };
  double c = 1.0;
  double d = 1.0 / guarded(1.0 - (a + b) * x / (a + 1.0));
  double result = d;
  for (int m = 1; m < most_terms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0));
    double factor = 1.0;
    for (const double term : {even, odd}) {
      d = 1.0 / guarded(1.0 + term * d);
      c = guarded(1.0 + term / c);
      factor = c * d;
      result *= factor;
    }
    if (std::abs(factor - 1.0) < 1e-15) break;
  }
  return result;
}

double incomplete_beta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(a, b, x) / a;
  return 1.0 - front * beta_fraction(b, a, 1.0 - x) / b;
}

}  // namespace

double corrected_akaike(double chi_squared, int data, int coefficients) {
  const double n = data;
  const double k = coefficients + 1.0;
  if (n - k - 1.0 <= 0.0) return std::numeric_limits<double>::infinity();
  // Data that a law meets to rounding would have minus infinity here.
  const double scaled = std::max(chi_squared / n, std::numeric_limits<double>::min());
  return n * std::log(scaled) + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0);
}

double f_survival(double value, double numerator, double denominator) {
  const double x = denominator / (denominator + numerator * value);
  return incomplete_beta(0.5 * denominator, 0.5 * numerator, x);
}

double chance_of_gain(const ModelScore& small, const ModelScore& large, int data) {
  const int extra = large.coefficients - small.coefficients;
  const int freedom = data - large.coefficients;
  const double fall = small.chi_squared - large.chi_squared;
  if (extra <= 0 || freedom <= 0 || !(fall > 0.0)) return 1.0;
  return f_survival((fall / extra) / (large.chi_squared / freedom), extra, freedom);
}

double interval_half_width(bool scale_from_scatter, int degrees_of_freedom) {
  constexpr double one_sided = 0.975;
  constexpr double normal = 1.959963985;
  return scale_from_scatter && degrees_of_freedom > 0
             ? dem::student_quantile(one_sided, degrees_of_freedom)
             : normal;
}

}  // namespace grainlaw::calibration
