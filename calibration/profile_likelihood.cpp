#include "calibration/profile_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace grainlaw::calibration {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// One side of the interval: how far chi^2 has risen when the unknown is held at a distance.
class Side {
 public:
  Side(const LeastSquaresProblem& problem,
       const Minimum& minimum,
       const Matrix& covariance,
       int unknown,
       double rise)
      : problem_(problem),
        minimum_(minimum),
        unknown_(static_cast<std::size_t>(unknown)),
        rise_(rise) {
    for (int k = 0; k < covariance.rows; ++k) {
      const double share = covariance(k, unknown) / covariance(unknown, unknown);
      along_.push_back(std::isfinite(share) ? share : 0.0);
    }
    for (std::size_t j = 0; j < problem_.unknowns.size(); ++j) {
      problem_.unknowns[j].start = minimum.values[j];
    }
    problem_.unknowns[unknown_].held = true;
  }

  /// sqrt(rise so far / rise) - 1: close to linear in the distance, zero at the limit.
  double excess(double value) {
    // The others follow as in a linear law from the last distance that was inside: from beyond the
    // limit a search may have strayed into another valley.
    LeastSquaresProblem there = problem_;
    const double step = value - problem_.unknowns[unknown_].start;
    for (std::size_t j = 0; j < along_.size(); ++j) {
      there.unknowns[j].start += j == unknown_ ? step : along_[j] * step;
    }
    const Minimum held = minimise(there);
    if (!std::isfinite(held.chi_squared)) return infinity;
    const double result =
        std::sqrt(std::max(0.0, held.chi_squared - minimum_.chi_squared) / rise_) - 1.0;
    for (std::size_t j = 0; result < 0.0 && j < held.values.size(); ++j) {
      problem_.unknowns[j].start = held.values[j];
    }
    return result;
  }

  double centre() const { return minimum_.values[unknown_]; }
  double bound() const { return problem_.unknowns[unknown_].lower; }

 private:
  LeastSquaresProblem problem_;
  const Minimum& minimum_;
  std::size_t unknown_;
  double rise_;
  std::vector<double> along_;
};

/// Root between `inside` (excess < 0) and `outside` (> 0) by regula falsi (Illinois).
double root(Side& side, double inside, double low, double outside, double high) {
  constexpr int most_steps = 60;
  constexpr double enough = 1e-3;  // of the half-width: far below what a probability of 95 % means
  int same_side = 0;
  for (int step = 0; step < most_steps && std::abs(high) > 0.0; ++step) {
    const double share = std::isfinite(high) ? low / (low - high) : 0.5;
    const double middle = inside + share * (outside - inside);
    const double value = side.excess(middle);
    if (std::abs(value) < enough) return middle;
    if (value < 0.0) {
      inside = middle;
      low = value;
      if (same_side == -1) high *= 0.5;
      same_side = -1;
    } else {
      outside = middle;
      high = value;
      if (same_side == 1) low *= 0.5;
      same_side = 1;
    }
    if (std::abs(outside - inside) < enough * std::abs(outside - side.centre())) break;
  }
  return 0.5 * (inside + outside);
}

double limit(Side side, double step, double direction) {
  constexpr int most_doublings = 20;  // a million standard errors
  double inside = side.centre();
  double low = -1.0;
  for (int k = 0; k < most_doublings; ++k, step *= 2.0) {
    double outside = side.centre() + direction * step;
    const bool ends = direction < 0.0 && outside <= side.bound();
    if (ends) outside = side.bound();
    if (ends && !(outside < inside)) return side.bound();
    const double high = side.excess(outside);
    if (high >= 0.0) return root(side, inside, low, outside, high);
    if (ends) return side.bound();
    inside = outside;
    low = high;
  }
  return direction * infinity;
}

}  // namespace

Interval profile_interval(const LeastSquaresProblem& problem,
                          const Minimum& minimum,
                          const Matrix& covariance,
                          int unknown,
                          double rise) {
  const double error = std::sqrt(covariance(unknown, unknown));
  const double value = minimum.values[static_cast<std::size_t>(unknown)];
  const double step = error > 0.0 && std::isfinite(error) ? error : std::max(std::abs(value), 1e-3);
  const Side side(problem, minimum, covariance, unknown, rise);
  return {.lower = limit(side, step, -1.0), .upper = limit(side, step, 1.0), .by_profile = true};
}

bool needs_profile(const Minimum& minimum, const Matrix& covariance, int unknown) {
  constexpr double strong = 0.95;
  constexpr double clear = 3.0;
  const double error = std::sqrt(covariance(unknown, unknown));
  if (!(std::abs(minimum.values[static_cast<std::size_t>(unknown)]) >= clear * error)) return true;
  for (int k = 0; k < covariance.rows; ++k) {
    const double scale = error * std::sqrt(covariance(k, k));
    if (k != unknown && std::abs(covariance(unknown, k)) > strong * scale) return true;
  }
  return false;
}

}  // namespace grainlaw::calibration
