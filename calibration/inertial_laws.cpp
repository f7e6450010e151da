#include "calibration/inertial_laws.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "calibration/differentiate.h"
#include "calibration/least_squares.h"
#include "calibration/observations.h"
#include "continuum/rheology.h"
#include "dem/estimate_text.h"

namespace grainlaw::calibration {
namespace {

constexpr double least_significance = 2.0;  // standard errors a term must differ from zero

/// A point y(I) of a law with errors in both.
struct LawPoint {
  double inertial_number = 0.0;
  double inertial_number_error = 0.0;
  double y = 0.0;
  double y_error = 0.0;
};

/// mu(I): unknowns mu0, beta and, with three of them, kappa.
struct FrictionModel {
  std::vector<LawPoint> points;
  std::vector<double> errors;

  template <class Scalar, std::size_t N>
  void operator()(const std::array<Scalar, N>& x, std::span<Scalar> r) const {
    const Scalar kappa = N > 2 ? x[N - 1] : Scalar(0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double I = points[i].inertial_number;
      // Past its pole the law is another one: no value there.
      const double none = 1.0 + kappa * I > 0.0 ? 0.0 : std::numeric_limits<double>::quiet_NaN();
      const Scalar mu = continuum::inertial_friction(x[0], x[1], kappa, Scalar(I));
      r[i] = (mu - points[i].y + none) / errors[i];
    }
  }
};

/// phi(I): unknowns phi0 and, with two of them, 1 / I_phi, which unlike I_phi passes smoothly
/// through the constant law.
struct FractionModel {
  std::vector<LawPoint> points;
  std::vector<double> errors;

  template <class Scalar, std::size_t N>
  void operator()(const std::array<Scalar, N>& x, std::span<Scalar> r) const {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Scalar I(points[i].inertial_number);
      const Scalar phi =
          N > 1 ? continuum::inertial_volume_fraction(x[0], 1.0 / x[N - 1], I) : x[0];
      r[i] = (phi - points[i].y) / errors[i];
    }
  }
};

/// sqrt(s_y^2 + (dy/dI s_I)^2).
template <class Slope>
std::vector<double> effective_errors(const std::vector<LawPoint>& points, Slope slope) {
  std::vector<double> errors;
  errors.reserve(points.size());
  for (const LawPoint& p : points) {
    errors.push_back(std::hypot(p.y_error, slope(p.inertial_number) * p.inertial_number_error));
  }
  return errors;
}

LeastSquaresProblem friction_problem(const std::vector<LawPoint>& points,
                                     std::span<const double> x) {
  const double kappa = x.size() > 2 ? x[2] : 0.0;
  const auto slope = [&](double I) { return x[1] / ((1.0 + kappa * I) * (1.0 + kappa * I)); };
  const FrictionModel model{points, effective_errors(points, slope)};
  LeastSquaresProblem problem;
  problem.unknowns = {{"mu0", x[0], 0.0}, {"beta", x[1], 0.0}};
  if (x.size() > 2) problem.unknowns.push_back({"kappa", x[2], 0.0});
  problem.residuals = static_cast<int>(points.size());
  problem.evaluate = x.size() > 2 ? differentiate<3>(model) : differentiate<2>(model);
  return problem;
}

LeastSquaresProblem fraction_problem(const std::vector<LawPoint>& points,
                                     std::span<const double> x) {
  const double slope = x.size() > 1 ? x[0] * x[1] : 0.0;
  const FractionModel model{points, effective_errors(points, [&](double) { return slope; })};
  LeastSquaresProblem problem;
  problem.unknowns = {{"phi0", x[0], 0.0}};
  if (x.size() > 1) problem.unknowns.push_back({.name = "1/I_phi", .start = x[1]});
  problem.residuals = static_cast<int>(points.size());
  problem.evaluate = x.size() > 1 ? differentiate<2>(model) : differentiate<1>(model);
  return problem;
}

/// A minimum with its errors.
struct LawFit {
  Minimum minimum;
  Uncertainty uncertainty;
  double scatter = 1.0;  ///< factor on the variances: chi^2 per degree of freedom where above 1

  double error(int j) const { return std::sqrt(uncertainty.covariance(j, j)); }
};

/// Points of different runs are independent. Where they scatter about the law by more than their
/// errors, the law is the weaker part and the errors are enlarged to match (Birge 1932).
template <class MakeProblem>
LawFit solve(MakeProblem make_problem, std::vector<double> start) {
  LawFit fit;
  const int unknowns = static_cast<int>(start.size());
  fit.minimum = minimise_reweighted(make_problem, std::move(start));
  fit.uncertainty = uncertainty(make_problem(fit.minimum.values), fit.minimum);
  const int freedom = static_cast<int>(fit.minimum.residuals.size()) - unknowns;
  if (freedom > 0) fit.scatter = std::max(1.0, fit.minimum.chi_squared / freedom);
  for (double& c : fit.uncertainty.covariance.values) c *= fit.scatter;
  return fit;
}

void note_scatter(const LawFit& fit, FitSummary& summary) {
  const std::size_t unknowns = fit.minimum.values.size();
  if (fit.minimum.residuals.size() == unknowns) {
    summary.notes.emplace_back(
        "as many points as coefficients: the law goes through them exactly and is not tested; "
        "errors come from those of the points alone");
  } else if (fit.scatter > 1.0) {
    std::ostringstream text;
    text.precision(3);
    text << "the points scatter about the law by " << std::sqrt(fit.scatter)
         << " times their errors; all errors are enlarged by this factor";
    summary.notes.push_back(text.str());
  }
}

/// In steady flow the balance of forces gives mu = tan(theta) exactly; the measured ratio stands in
/// where it contradicts that (flow_point says so).
std::vector<LawPoint> friction_points(const std::vector<FlowPoint>& points) {
  const std::vector<double> errors = weight_errors(collect(points, &FlowPoint::inertial_number));
  std::vector<LawPoint> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const dem::Estimate friction = friction_for_fit(points[i]);
    result.push_back({points[i].inertial_number.value, errors[i], friction.value, friction.error});
  }
  return result;
}

std::vector<LawPoint> fraction_points(const std::vector<FlowPoint>& points) {
  const std::vector<dem::Estimate> fractions = collect(points, &FlowPoint::volume_fraction);
  const std::vector<double> errors = weight_errors(fractions);
  std::vector<LawPoint> result = friction_points(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    result[i].y = fractions[i].value;
    result[i].y_error = errors[i];
  }
  return result;
}

/// Intercept and slope of the line through the points of lowest and highest I.
std::array<double, 2> line_through_ends(const std::vector<LawPoint>& points) {
  const auto [low, high] =
      std::minmax_element(points.begin(), points.end(), [](const LawPoint& p, const LawPoint& q) {
        return p.inertial_number < q.inertial_number;
      });
  const double slope = (high->y - low->y) / (high->inertial_number - low->inertial_number);
  return {low->y - slope * low->inertial_number, slope};
}

std::string why_kappa_is_dropped(const LawFit& curved) {
  if (!curved.minimum.converged) return "the fit with it did not converge";
  const std::vector<double>& x = curved.minimum.values;
  const double error = curved.error(2);
  std::ostringstream text;
  text.precision(3);
  text << "the data give " << value_with_error(x[2], error);
  if (curved.minimum.at_bound[2]) text << ", at its bound (error one-sided)";
  const double largest = x[2] + 1.645 * error;  // one-sided 95 % of a normal distribution
  text << ", less than " << least_significance
       << " standard errors from the linear law; the largest friction mu0 + beta/kappa is above "
       << x[0] + x[1] / largest << " (95 %, one-sided, normal errors)";
  return text.str();
}

bool kappa_is_measured(const LawFit& curved) {
  return curved.minimum.converged && !curved.minimum.at_bound[2] &&
         curved.uncertainty.null_space.empty() &&
         curved.minimum.values[2] >= least_significance * curved.error(2);
}

FittedLaw express(const std::vector<std::string>& names, const LawFit& fit) {
  FittedLaw law{fit.minimum.values,
                fit.uncertainty.covariance,
                describe(names, fit.minimum, fit.uncertainty)};
  note_scatter(fit, law.summary);
  return law;
}

/// From 1 / I_phi to I_phi, error by the derivative.
void invert_second(LawFit& fit) {
  const double inverse = fit.minimum.values[1];
  const std::array<double, 2> factor{1.0, -1.0 / (inverse * inverse)};
  fit.minimum.values[1] = 1.0 / inverse;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) fit.uncertainty.covariance(i, j) *= factor[i] * factor[j];
  }
}

}  // namespace

std::vector<dem::Estimate> collect(const std::vector<FlowPoint>& points,
                                   dem::Estimate FlowPoint::*quantity) {
  std::vector<dem::Estimate> estimates;
  estimates.reserve(points.size());
  for (const FlowPoint& point : points) estimates.push_back(point.*quantity);
  return estimates;
}

int count_tilts(const std::vector<FlowPoint>& points) {
  std::vector<double> tilts;
  tilts.reserve(points.size());
  for (const FlowPoint& point : points) tilts.push_back(point.inclination);
  std::sort(tilts.begin(), tilts.end());
  const auto same = [](double one, double next) { return next - one < 1e-9; };  // rounding of files
  return static_cast<int>(std::unique(tilts.begin(), tilts.end(), same) - tilts.begin());
}

FittedLaw fit_friction(const std::vector<FlowPoint>& points) {
  const std::vector<LawPoint> data = friction_points(points);
  const auto problem_at = [&](std::span<const double> x) { return friction_problem(data, x); };
  const auto [mu0, beta] = line_through_ends(data);
  if (!(beta > 0.0) || !std::isfinite(beta)) {
    throw FitError(
        "friction does not rise with the inertial number over these runs: a law fitted to them "
        "would have no unique flow; use tilts further apart or average longer");
  }
  const LawFit linear = solve(problem_at, {std::max(mu0, 0.0), beta});
  require_converged(linear.minimum, "mu(I)");
  std::string reason = "with three tilts or fewer the fit would be exact";
  if (count_tilts(points) > 3) {
    const LawFit curved =
        solve(problem_at, {linear.minimum.values[0], linear.minimum.values[1], 0.0});
    if (kappa_is_measured(curved)) return express({"mu0", "beta", "kappa"}, curved);
    reason = why_kappa_is_dropped(curved);
  }
  FittedLaw law = express({"mu0", "beta"}, linear);
  law.summary.not_identifiable.push_back("kappa is dropped (linear law mu0 + beta I): " + reason);
  return law;
}

FittedLaw fit_volume_fraction(const std::vector<FlowPoint>& points) {
  const std::vector<LawPoint> data = fraction_points(points);
  const auto problem_at = [&](std::span<const double> x) { return fraction_problem(data, x); };
  const auto [phi0, slope] = line_through_ends(data);
  // Any decrease will do to start from, but 1 / I_phi = 0 has no derivative.
  const double start = slope < 0.0 ? -slope / phi0 : 1e-3;
  LawFit falling = solve(problem_at, {phi0, start});
  const double inverse = falling.minimum.values[1];
  const double error = falling.error(1);
  if (falling.minimum.converged && inverse > 0.0 && inverse >= least_significance * error) {
    invert_second(falling);
    return express({"phi0", "I_phi"}, falling);
  }
  const LawFit constant = solve(problem_at, {phi0});
  require_converged(constant.minimum, "phi(I)");
  FittedLaw law = express({"phi0"}, constant);
  std::ostringstream text;
  text.precision(3);
  text << "I_phi is dropped (constant phi): the data give 1/I_phi = "
       << value_with_error(inverse, error) << ", no measured decrease of phi with I";
  law.summary.not_identifiable.push_back(text.str());
  return law;
}

}  // namespace grainlaw::calibration
