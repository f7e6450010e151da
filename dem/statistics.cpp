#include "dem/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

namespace grainlaw::dem {
namespace {

double mean_of(std::span<const double> series) {
  return std::accumulate(series.begin(), series.end(), 0.0) / static_cast<double>(series.size());
}

/// Sums of the first k distances from the mean, k = 0 ... N: any block is a difference of two.
std::vector<double> running_sums(std::span<const double> series, double mean) {
  std::vector<double> sums{0.0};
  sums.reserve(series.size() + 1);
  for (const double value : series) sums.push_back(sums.back() + value - mean);
  return sums;
}

/// Variance of the mean from all blocks of the given length, overlapping ones included, taken as
/// independent otherwise (Meketon and Schmeiser 1984).
double variance_of_mean(std::span<const double> sums, std::size_t length) {
  const std::size_t n = sums.size() - 1;
  double squares = 0.0;
  for (std::size_t k = 0; k + length <= n; ++k) {
    const double sum = sums[k + length] - sums[k];
    squares += sum * sum;
  }
  return squares /
         (static_cast<double>(length) * static_cast<double>((n - length + 1) * (n - length)));
}

/// Blocks of length B miss the correlation across their ends and give V (1 - tau/B) of the true
/// variance V of the mean, to first order; tau = V / (2 variance of single samples). Solved for V.
double without_block_bias(double variance, double single, std::size_t length) {
  if (length == 1 || single == 0.0) return variance;
  const double most = single * static_cast<double>(length);  // tau = B / 2: no more can be told
  return most * (1.0 - std::sqrt(std::max(0.0, 1.0 - 2.0 * variance / most)));
}

/// Probability that |t| is below the given value, for a whole number of degrees (Abramowitz and
/// Stegun 26.7.3, 26.7.4).
double student_inside(double t, int degrees) {
  const double angle = std::atan(t / std::sqrt(degrees));
  const double cos2 = std::cos(angle) * std::cos(angle);
  const bool odd = degrees % 2 == 1;
  double term = odd ? std::cos(angle) : 1.0;
  double sum = degrees == 1 ? 0.0 : term;
  for (int k = odd ? 2 : 1; k <= degrees - 3; k += 2) {
    term *= cos2 * k / (k + 1.0);
    sum += term;
  }
  return odd ? 2.0 / std::numbers::pi * (angle + std::sin(angle) * sum) : std::sin(angle) * sum;
}

/// Is a block of this length, or more, long enough for the variance it gives?
bool long_enough(std::size_t length, std::size_t samples, double twice_tau) {
  const double cube = std::pow(static_cast<double>(length), 3.0);
  return cube > 2.0 * static_cast<double>(samples) * twice_tau * twice_tau;
}

/// Student's t for a whole number of degrees, by bisection.
double student_quantile_of_whole(double probability, int degrees) {
  const double inside = 2.0 * probability - 1.0;
  double low = 0.0, high = 1.0;
  while (student_inside(high, degrees) < inside) high *= 2.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (student_inside(middle, degrees) < inside ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

BlockAverage block_average(std::span<const double> series) {
  constexpr std::size_t fewest_blocks = 4;
  const std::size_t n = series.size();
  const double mean = n > 0 ? mean_of(series) : std::nan("");
  BlockAverage result{
      .mean = mean, .error = std::nan(""), .effective_samples = static_cast<double>(n)};
  if (n < fewest_blocks) return result;
  const std::vector<double> sums = running_sums(series, mean);
  const double single = variance_of_mean(sums, 1);
  if (!(single > 0.0)) {
    result.error = single;
    return result;
  }
  double variance = single;
  for (std::size_t length = 1; n / length >= fewest_blocks; length += 1 + length / 16) {
    variance = variance_of_mean(sums, length);
    result.block_length = length;
    if (long_enough(length, n, variance / single)) break;
  }
  variance = without_block_bias(variance, single, result.block_length);
  result.error = std::sqrt(variance);
  result.correlation_time = 0.5 * variance / single;
  result.effective_samples = static_cast<double>(n) * std::min(1.0, single / variance);
  return result;
}

double degrees_of_freedom(double effective_samples) {
  const double blocks = std::max(4.0, std::cbrt(0.5 * effective_samples * effective_samples));
  // The correction solves v = V (1 - V / 2 V_most) for V, and makes errors of v larger by 1/cost.
  const double ratio = std::min(1.0, blocks / effective_samples);  // V / V_most = 2 tau / B
  const double cost = (1.0 - ratio) / (1.0 - 0.5 * ratio);
  return std::max(1.0, 1.5 * (blocks - 1.0) * cost * cost);
}

double half_width(const Estimate& estimate, double probability) {
  const bool known = std::isfinite(estimate.effective_samples);
  const double degrees = known ? degrees_of_freedom(estimate.effective_samples) : INFINITY;
  return student_quantile(0.5 + 0.5 * probability, degrees) * estimate.error;
}

std::size_t mser_truncation(std::span<const double> series) {
  const std::size_t n = series.size();
  std::size_t best = 0;
  double smallest = std::numeric_limits<double>::infinity();
  double count = 0.0, mean = 0.0, squares = 0.0;  // of series[k..n), grown from the end
  for (std::size_t k = n; k-- > 0;) {
    count += 1.0;
    const double difference = series[k] - mean;
    mean += difference / count;
    squares += difference * (series[k] - mean);
    if (2 * k > n || count < 2.0) continue;
    const double score = squares / (count * count);
    if (score <= smallest) {
      smallest = score;
      best = k;
    }
  }
  return best;
}

Drift linear_drift(std::span<const double> series) {
  const auto n = static_cast<double>(series.size());
  if (series.size() < 4) return {0.0, std::nan(""), 0.0};
  const double mean = mean_of(series);
  const double middle = 0.5 * (n - 1.0);
  double covariance = 0.0, variance = 0.0;
  for (std::size_t k = 0; k < series.size(); ++k) {
    const double x = static_cast<double>(k) - middle;
    covariance += x * (series[k] - mean);
    variance += x * x;
  }
  const double slope = covariance / variance;
  std::vector<double> rest(series.begin(), series.end());
  for (std::size_t k = 0; k < rest.size(); ++k) {
    rest[k] -= slope * (static_cast<double>(k) - middle);
  }
  const BlockAverage scatter = block_average(rest);
  // A slope over N samples is known to sqrt(12) errors of the mean over N.
  return {slope * n, std::sqrt(12.0) * scatter.error, scatter.effective_samples};
}

bool Drift::significant(double probability) const {
  const double degrees = effective_samples - 2.0;
  if (!(degrees >= 1.0)) return false;
  return std::abs(change) > student_quantile(0.5 + 0.5 * probability, degrees) * error;
}

double Drift::most(double probability) const {
  return std::abs(change) +
         student_quantile(0.5 + 0.5 * probability, effective_samples - 2.0) * error;
}

double student_quantile(double probability, double degrees) {
  constexpr double most = 1000.0;  // within 0.3 % of a normal distribution, for any use made here
  degrees = std::clamp(degrees, 1.0, most);
  const double whole = std::floor(degrees);
  const double below = student_quantile_of_whole(probability, static_cast<int>(whole));
  if (degrees == whole) return below;
  const double above = student_quantile_of_whole(probability, static_cast<int>(whole) + 1);
  const double share = (1.0 / whole - 1.0 / degrees) * whole * (whole + 1.0);
  return below * std::pow(above / below, share);
}

}  // namespace grainlaw::dem
