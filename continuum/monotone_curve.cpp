#include "continuum/monotone_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "continuum/rheology_table.h"

namespace grainlaw::continuum {
namespace {

void require_points(const std::vector<double>& x, const std::vector<double>& y) {
  if (x.size() != y.size() || x.size() < 2)
    throw TableError(fmt::format(
        "a tabulated mu(I) needs two pairs or more, not {} of I and {} of mu", x.size(), y.size()));
  for (std::size_t k = 0; k < x.size(); ++k)
    if (!std::isfinite(x[k]) || !std::isfinite(y[k]) || x[k] < 0.0 || y[k] < 0.0 ||
        (k > 0 && x[k] <= x[k - 1]))
      throw TableError(fmt::format(
          "pair {} of the tabulated mu(I), ({}, {}): I must rise from pair to pair, and "
          "neither may be negative",
          k + 1,
          x[k],
          y[k]));
}

/// Steady flow is unstable where stress does not rise with the shear rate.
void require_rise(const std::vector<double>& x, const std::vector<double>& y) {
  std::string intervals;
  for (std::size_t k = 0; k + 1 < x.size(); ++k) {
    if (y[k + 1] > y[k]) continue;
    const double from = x[k];
    while (k + 2 < x.size() && y[k + 2] <= y[k + 1]) ++k;
    intervals +=
        fmt::format("{}from I = {} to {}", intervals.empty() ? "" : " and ", from, x[k + 1]);
  }
  if (!intervals.empty())
    throw TableError(fmt::format(
        "the tabulated mu(I) does not rise {}: d mu / dI <= 0 there, no steady flow is stable and "
        "a stress has more than one shear rate; leave out the points of one branch",
        intervals));
}

/// Slopes between means of the neighbours', limited so that no cubic overshoots: (alpha, beta), in
/// units of the secant, must lie within a circle of radius 3.
std::vector<double> limited_slopes(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t last = x.size() - 1;
  const auto secant = [&](std::size_t k) { return (y[k + 1] - y[k]) / (x[k + 1] - x[k]); };
  std::vector<double> slope(x.size());
  slope.front() = secant(0);
  slope.back() = secant(last - 1);
  for (std::size_t k = 1; k < last; ++k) slope[k] = 0.5 * (secant(k - 1) + secant(k));
  for (std::size_t k = 0; k < last; ++k) {
    const double size = std::hypot(slope[k], slope[k + 1]);
    const double most = 3.0 * secant(k);
    if (size <= most) continue;
    slope[k] *= most / size;
    slope[k + 1] *= most / size;
  }
  return slope;
}

}  // namespace

MonotoneCurve::MonotoneCurve(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)) {
  require_points(x_, y_);
  require_rise(x_, y_);
  slope_ = limited_slopes(x_, y_);
}

MonotoneCurve::Cubic MonotoneCurve::coefficients(std::size_t k) const {
  const double length = x_[k + 1] - x_[k];
  const double secant = (y_[k + 1] - y_[k]) / length;
  return {slope_[k],
          (3.0 * secant - 2.0 * slope_[k] - slope_[k + 1]) / length,
          (slope_[k] + slope_[k + 1] - 2.0 * secant) / (length * length)};
}

double MonotoneCurve::slope(double x) const {
  if (x < x_.front() || x > x_.back()) return 0.0;
  std::size_t k = 0;
  while (k + 2 < x_.size() && x > x_[k + 1]) ++k;
  const auto [first, second, third] = coefficients(k);
  const double from = x - x_[k];
  return first + from * (2.0 * second + 3.0 * third * from);
}

std::optional<double> MonotoneCurve::inverse(double y) const {
  if (y > y_.back()) return std::nullopt;
  if (y <= y_.front()) return x_.front();
  const auto above = std::lower_bound(y_.begin(), y_.end(), y);
  const auto k = static_cast<std::size_t>(above - y_.begin());
  double low = x_[k - 1], high = x_[k];
  double x = low + (high - low) * (y - y_[k - 1]) / (y_[k] - y_[k - 1]);
  for (int i = 0; i < 100; ++i) {  // Newton, kept inside a bracket that shrinks
    const double excess = (*this)(x)-y;
    (excess > 0.0 ? high : low) = x;
    const double next = x - excess / slope(x);
    const double kept = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(kept - x) <= 1e-15 * x || high - low <= 1e-15 * high) return kept;
    x = kept;
  }
  return x;
}

}  // namespace grainlaw::continuum
