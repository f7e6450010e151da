#include "calibration/ratio_laws.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "calibration/differentiate.h"
#include "calibration/model_choice.h"
#include "dem/estimate_text.h"

namespace grainlaw::calibration {
namespace {

/// ln Xi = x0 + x1 t.
struct Line {
  std::vector<double> t;
  std::vector<double> y;
  std::vector<double> errors;

  template <class Scalar>
  void operator()(const std::array<Scalar, 2>& x, std::span<Scalar> r) const {
    for (std::size_t i = 0; i < y.size(); ++i) r[i] = (x[0] + x[1] * t[i] - y[i]) / errors[i];
  }
};

std::string why_left_out(const RatioPoint& point, const RatioRule& rule, bool logarithmic) {
  std::ostringstream text;
  text.precision(3);
  const dem::Estimate& xi = point.ratio;
  const bool usable = std::isfinite(point.x) && (!logarithmic || point.x > 0.0);
  if (!usable) {
    text << "x = " << point.x << " is no number to fit to";
  } else if (!(std::isfinite(xi.value) && std::isfinite(xi.error) && xi.error > 0.0)) {
    text << "Xi or its error is not a number";
  } else if (xi.value < rule.least_significance * xi.error || xi.value <= 0.0) {
    text << "Xi = " << value_with_error(xi.value, xi.error) << " is not detected ("
         << rule.least_significance << " standard errors)";
  } else if (point.x < rule.least_x || point.x > rule.largest_x) {
    text << "x = " << point.x << " is outside " << rule.least_x << " to " << rule.largest_x;
  }
  return text.str();
}

void require_line(const Line& line) {
  const auto [low, high] = std::minmax_element(line.t.begin(), line.t.end());
  if (line.t.size() >= 3 && *high > *low) return;
  throw FitError(
      "a law of Xi needs at least 3 points at different x with Xi told from 0; there are " +
      std::to_string(line.t.size()));
}

FittedCoefficient with_interval(FittedCoefficient c, double half_width) {
  c.interval = {.lower = c.value - half_width * c.error, .upper = c.value + half_width * c.error};
  return c;
}

/// exp of a coefficient: the interval follows exactly, the error to first order.
FittedCoefficient exponential(const FittedCoefficient& c) {
  FittedCoefficient result = c;
  result.value = std::exp(c.value);
  result.error = result.value * c.error;
  result.interval.lower = std::exp(c.interval.lower);
  result.interval.upper = std::exp(c.interval.upper);
  return result;
}

RatioLaw fit_line(const std::vector<RatioPoint>& points,
                  const RatioRule& rule,
                  bool logarithmic,
                  const std::array<std::string, 2>& names) {
  RatioLaw law;
  Line line;
  std::vector<std::string> left_out;
  for (const RatioPoint& point : points) {
    const std::string reason = why_left_out(point, rule, logarithmic);
    law.used.push_back(reason.empty());
    if (!reason.empty()) {
      left_out.push_back(point.name + " is left out: " + reason);
      continue;
    }
    line.t.push_back(logarithmic ? std::log(point.x) : point.x);
    line.y.push_back(std::log(point.ratio.value));
    line.errors.push_back(point.ratio.error / point.ratio.value);
  }
  require_line(line);
  const LeastSquaresProblem problem{.unknowns = {{.name = "ln " + names[0], .start = line.y[0]},
                                                 {.name = names[1], .start = 0.0}},
                                    .residuals = static_cast<int>(line.y.size()),
                                    .evaluate = differentiate<2>(line)};
  const Minimum minimum = minimise(problem);
  require_converged(minimum, "Xi");
  const int freedom = problem.residuals - 2;
  const double scatter = std::max(1.0, minimum.chi_squared / freedom);
  Uncertainty errors = uncertainty(problem, minimum);
  for (double& c : errors.covariance.values) c *= scatter;
  law.summary = describe({"ln " + names[0], names[1]}, minimum, errors);
  law.summary.left_out = left_out;
  const double half = interval_half_width(scatter > 1.0, freedom);
  for (FittedCoefficient& c : law.summary.coefficients) c = with_interval(c, half);
  law.factor = exponential(law.summary.coefficients[0]);
  law.factor.name = names[0];
  law.rate = law.summary.coefficients[1];
  return law;
}

}  // namespace

RatioLaw fit_ratio_power_law(const std::vector<RatioPoint>& points, const RatioRule& rule) {
  return fit_line(points, rule, true, {"J", "alpha"});
}

RatioLaw fit_ratio_exponential(const std::vector<RatioPoint>& points, const RatioRule& rule) {
  return fit_line(points, rule, false, {"c1", "c2"});
}

}  // namespace grainlaw::calibration
