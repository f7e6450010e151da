#include "calibration/contact_friction_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/differentiate.h"
#include "calibration/least_squares.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {
namespace {

/// Q_inf, Q_0 and 1/mu_p0.
struct Curve {
  std::vector<double> contact_frictions;
  std::vector<double> values;
  std::vector<double> errors;

  template <class Scalar>
  void operator()(const std::array<Scalar, 3>& x, std::span<Scalar> r) const {
    using std::exp;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Scalar decay = exp(-contact_frictions[i] * x[2]);
      r[i] = (x[0] + (x[1] - x[0]) * decay - values[i]) / errors[i];
    }
  }
};

std::size_t count_different(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return static_cast<std::size_t>(std::unique(values.begin(), values.end()) - values.begin());
}

LeastSquaresProblem problem_of(const Curve& curve) {
  const auto [low, high] =
      std::minmax_element(curve.contact_frictions.begin(), curve.contact_frictions.end());
  const auto value_at = [&](auto where) {
    return curve.values[static_cast<std::size_t>(where - curve.contact_frictions.begin())];
  };
  return {.unknowns = {{.name = "Q_inf", .start = value_at(high)},
                       {.name = "Q_0", .start = value_at(low)},
                       {.name = "1/mu_p0", .start = 4.0 / (*high - *low), .lower = 0.0}},
          .residuals = static_cast<int>(curve.values.size()),
          .evaluate = differentiate<3>(curve)};
}

double value(const std::vector<double>& x, double contact_friction) {
  return x[0] + (x[1] - x[0]) * std::exp(-contact_friction * x[2]);
}

Curve without(const Curve& curve, std::size_t i) {
  Curve rest = curve;
  const auto drop = [i](std::vector<double>& v) {
    v.erase(v.begin() + static_cast<std::ptrdiff_t>(i));
  };
  drop(rest.contact_frictions);
  drop(rest.values);
  drop(rest.errors);
  return rest;
}

/// Largest miss of a table inside the range of the others by the curve through those.
double interpolation_error(const Curve& curve) {
  const auto [low, high] =
      std::minmax_element(curve.contact_frictions.begin(), curve.contact_frictions.end());
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < curve.values.size(); ++i) {
    const double at = curve.contact_frictions[i];
    const Curve rest = without(curve, i);
    if (at == *low || at == *high || count_different(rest.contact_frictions) < 4) continue;
    const Minimum minimum = minimise(problem_of(rest));
    if (minimum.converged) {
      worst = std::fmax(worst, std::abs(value(minimum.values, at) - curve.values[i]));
    }
  }
  return worst;
}

/// Errors of equal weights come from the scatter; those of given errors are enlarged to it.
Uncertainty scaled_uncertainty(const LeastSquaresProblem& problem,
                               const Minimum& minimum,
                               bool equal_weights) {
  Uncertainty result = uncertainty(problem, minimum);
  const double scatter = minimum.chi_squared / (problem.residuals - 3);
  for (double& c : result.covariance.values) c *= equal_weights ? scatter : std::max(1.0, scatter);
  return result;
}

FitSummary describe_curve(const Minimum& minimum, Uncertainty errors) {
  Minimum shown = minimum;
  const double inverse = minimum.values[2];
  shown.values[2] = 1.0 / inverse;
  for (int k = 0; k < 3; ++k) {
    errors.covariance(2, k) *= -1.0 / (inverse * inverse);
    errors.covariance(k, 2) *= -1.0 / (inverse * inverse);
  }
  return describe({"Q_inf", "Q_0", "mu_p0"}, shown, errors);
}

std::vector<dem::Estimate> collect(std::span<const continuum::RheologyTable> tables,
                                   const std::string& name) {
  std::vector<dem::Estimate> values;
  for (const continuum::RheologyTable& table : tables) {
    dem::Estimate estimate{continuum::coefficient(table, name), 0.0};
    if (table.covariance) {
      const auto& names = table.covariance->names;
      const auto found = std::find(names.begin(), names.end(), name);
      const auto k = static_cast<std::size_t>(found - names.begin());
      if (found != names.end()) estimate.error = std::sqrt((*table.covariance)(k, k));
    }
    values.push_back(estimate);
  }
  return values;
}

/// The no-slip height belongs to a base, not to the grains.
bool belongs_to_grains(const std::string& name) {
  return name != "no_slip_height" && name != "mass_below";
}

bool has(const continuum::RheologyTable& table, const std::string& name) {
  const auto names = continuum::coefficient_names(table);
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Of all tables, each once.
std::vector<std::string> names_of(std::span<const continuum::RheologyTable> tables) {
  std::vector<std::string> names;
  for (const continuum::RheologyTable& table : tables) {
    for (const std::string& name : continuum::coefficient_names(table)) {
      const bool known = std::find(names.begin(), names.end(), name) != names.end();
      if (!known && belongs_to_grains(name)) names.push_back(name);
    }
  }
  return names;
}

bool all_equal(const std::vector<dem::Estimate>& values) {
  return std::all_of(values.begin(), values.end(), [&](const dem::Estimate& v) {
    return v.value == values.front().value;
  });
}

std::string too_few(std::vector<double> contact_frictions, std::size_t tables) {
  std::sort(contact_frictions.begin(), contact_frictions.end());
  std::string at;
  for (const double mu_p : contact_frictions) {
    at += (at.empty() ? "" : ", ") + fmt::format("{}", mu_p);
  }
  return fmt::format(
      "stated by {} of {} tables, at mu_p = {}; a curve has three coefficients and needs 4 "
      "different mu_p",
      contact_frictions.size(),
      tables,
      at);
}

/// What keeps coefficients from a curve, each reason once with all it holds for.
class Reasons {
 public:
  void add(const std::string& name, const std::string& reason) {
    const auto found = std::find_if(
        reasons_.begin(), reasons_.end(), [&](const auto& one) { return one.first == reason; });
    if (found == reasons_.end()) {
      reasons_.emplace_back(reason, name);
    } else {
      found->second += ", " + name;
    }
  }
  std::vector<std::string> sentences() const {
    std::vector<std::string> all;
    for (const auto& [reason, names] : reasons_) all.push_back(names + ": " + reason);
    return all;
  }

 private:
  std::vector<std::pair<std::string, std::string>> reasons_;
};

}  // namespace

double FrictionDependence::operator()(double contact_friction) const {
  return value({at_infinity, at_zero, 1.0 / scale}, contact_friction);
}

FrictionDependence fit_friction_dependence(const std::vector<double>& contact_frictions,
                                           const std::vector<dem::Estimate>& values) {
  if (values.size() != contact_frictions.size() || count_different(contact_frictions) < 4) {
    throw FitError(
        "the dependence on contact friction has three coefficients: it needs tables at 4 different "
        "mu_p at least, there are " +
        std::to_string(count_different(contact_frictions)));
  }
  Curve curve{
      .contact_frictions = contact_frictions, .values = {}, .errors = weight_errors(values)};
  for (const dem::Estimate& v : values) curve.values.push_back(v.value);
  const bool equal_weights = std::none_of(
      values.begin(), values.end(), [](const dem::Estimate& v) { return v.error > 0.0; });
  const LeastSquaresProblem problem = problem_of(curve);
  const Minimum minimum = minimise(problem);
  require_converged(minimum, "the dependence on contact friction");
  if (!(minimum.values[2] > 0.0)) {
    throw FitError("the values show no saturation with mu_p: the curve of eq. 1B does not exist");
  }
  FrictionDependence fit;
  fit.at_infinity = minimum.values[0];
  fit.at_zero = minimum.values[1];
  fit.scale = 1.0 / minimum.values[2];
  fit.summary = describe_curve(minimum, scaled_uncertainty(problem, minimum, equal_weights));
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    fit.deviation.push_back(values[i].value - fit(contact_frictions[i]));
    squares += fit.deviation.back() * fit.deviation.back();
  }
  fit.rms = std::sqrt(squares / (static_cast<double>(values.size()) - 3.0));
  fit.interpolation_error = interpolation_error(curve);
  return fit;
}

FrictionDependences fit_friction_dependences(std::span<const continuum::RheologyTable> tables) {
  FrictionDependences result;
  Reasons reasons;
  for (const std::string& name : names_of(tables)) {
    std::vector<continuum::RheologyTable> having;
    std::vector<double> contact_frictions;
    for (const continuum::RheologyTable& table : tables) {
      if (!has(table, name)) continue;
      having.push_back(table);
      contact_frictions.push_back(table.contact_friction);
    }
    const std::vector<dem::Estimate> values = collect(having, name);
    try {
      if (count_different(contact_frictions) < 4) {
        reasons.add(name, too_few(contact_frictions, tables.size()));
      } else if (all_equal(values)) {
        result.constants[name] = values.front().value;
      } else {
        result.coefficients[name] = fit_friction_dependence(contact_frictions, values);
      }
    } catch (const FitError& error) {
      reasons.add(name, error.what());
    }
  }
  result.left_out = reasons.sentences();
  return result;
}

continuum::RheologyTable interpolate(const FrictionDependences& curves,
                                     const continuum::RheologyTable& like,
                                     double contact_friction) {
  continuum::RheologyTable table = like;
  table.contact_friction = contact_friction;
  table.base.reset();
  continuum::Covariance covariance;
  for (const std::string& name : continuum::coefficient_names(table)) {
    if (curves.constants.contains(name)) continue;
    const auto found = curves.coefficients.find(name);
    if (found == curves.coefficients.end()) {
      throw FitError("no curve in mu_p for the coefficient '" + name + "'");
    }
    continuum::set_coefficient(table, name, found->second(contact_friction));
    covariance.names.push_back(name);
  }
  const std::size_t n = covariance.names.size();
  covariance.matrix.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const FrictionDependence& curve = curves.coefficients.at(covariance.names[i]);
    covariance.matrix[i * n + i] = std::pow(std::fmax(curve.rms, curve.interpolation_error), 2);
  }
  table.covariance = covariance;
  table.provenance = {
      .source = "grainlaw, interpolated in contact friction (Shi et al. 2020, eq. 1B)",
      .data = like.provenance.data,
      .checked_against = {}};
  return table;
}

}  // namespace grainlaw::calibration
