#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace grainlaw::continuum {

/// A number with its derivatives with respect to N variables: f(Dual) carries df exactly (forward
/// differentiation). Holds what the laws use.
template <std::size_t N>
struct Dual {
  double value = 0.0;
  std::array<double, N> slope{};

  Dual() = default;
  Dual(double v) : value(v) {}  // NOLINT: a constant is a number without slope
  /// The i-th variable itself.
  static Dual variable(double v, std::size_t i) {
    Dual x(v);
    x.slope[i] = 1.0;
    return x;
  }
  /// f(x) from f and df/dx at the value of x.
  Dual mapped(double f, double by_x) const {
    Dual result(f);
    for (std::size_t i = 0; i < N; ++i) result.slope[i] = by_x * slope[i];
    return result;
  }

  friend Dual operator+(Dual x, const Dual& y) {
    x.value += y.value;
    for (std::size_t i = 0; i < N; ++i) x.slope[i] += y.slope[i];
    return x;
  }
  friend Dual operator-(const Dual& x, const Dual& y) { return x + y.mapped(-y.value, -1.0); }
  friend Dual operator*(const Dual& x, const Dual& y) {
    return x.mapped(0.0, y.value) + y.mapped(x.value * y.value, x.value);
  }
  friend Dual operator/(const Dual& x, const Dual& y) {
    return x * y.mapped(1.0 / y.value, -1.0 / (y.value * y.value));
  }
  friend bool operator>(const Dual& x, const Dual& y) { return x.value > y.value; }
  friend Dual sqrt(const Dual& x) {
    const double root = std::sqrt(x.value);
    return x.mapped(root, 0.5 / root);
  }
  friend Dual pow(const Dual& x, const Dual& y) {
    const double power = std::pow(x.value, y.value);
    return x.mapped(power, y.value * power / x.value) + y.mapped(0.0, power * std::log(x.value));
  }
};

}  // namespace grainlaw::continuum
