#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace grainlaw::continuum {

/// A rising curve through given points: cubic between them, without overshoot and with a continuous
/// slope (Fritsch & Carlson 1980, SIAM J. Numer. Anal. 17, 238); constant beyond the first and the
/// last.
class MonotoneCurve {
 public:
  /// Two points or more; x >= 0 rising strictly. Throws TableError, where y does not rise strictly
  /// with the intervals of x it does not rise in.
  MonotoneCurve(std::vector<double> x, std::vector<double> y);

  const std::vector<double>& x() const { return x_; }
  const std::vector<double>& y() const { return y_; }

  template <class T>
  T operator()(const T& x) const {
    if (!(x > x_.front())) return T(y_.front());
    if (x > x_.back()) return T(y_.back());
    std::size_t k = 0;
    while (k + 2 < x_.size() && x > x_[k + 1]) ++k;
    const auto [first, second, third] = coefficients(k);
    const T from = x - x_[k];
    return y_[k] + from * (first + from * (second + from * third));
  }

  /// 0 beyond the ends.
  double slope(double x) const;
  /// Least x of the value y; absent above the last.
  std::optional<double> inverse(double y) const;

 private:
  /// y - y_k = (first + (second + third s) s) s, s = x - x_k.
  struct Cubic {
    double first, second, third;
  };
  Cubic coefficients(std::size_t k) const;

  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> slope_;
};

}  // namespace grainlaw::continuum
