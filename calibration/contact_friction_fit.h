#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "continuum/rheology_table.h"
#include "dem/estimate.h"

namespace grainlaw::calibration {

/// A coefficient of the laws as a function of the contact friction of the grains, Q(mu_p) = Q_inf +
/// (Q_0 - Q_inf) exp(-mu_p / mu_p0)  (Shi et al. 2020, eq. 1B).
struct FrictionDependence {
  double at_infinity = 0.0;
  double at_zero = 0.0;
  double scale = 0.0;             ///< mu_p0
  FitSummary summary;             ///< Q_inf, Q_0, mu_p0
  std::vector<double> deviation;  ///< Q - fit, per table fitted
  double rms = 0.0;               ///< of the deviations over n - 3 degrees of freedom
  /// Largest |Q - fit to the other tables| where mu_p lies between those of others: what
  /// interpolation costs. NaN for fewer than 5 tables.
  double interpolation_error = 0.0;

  double operator()(double contact_friction) const;
};

/// `values` with errors weigh by them, without all weigh alike. Throws FitError for fewer than 4
/// different mu_p or where no such curve is found.
FrictionDependence fit_friction_dependence(const std::vector<double>& contact_frictions,
                                           const std::vector<dem::Estimate>& values);

/// The curve of every coefficient, by name, through the tables that state it, weighted by their
/// covariances. A coefficient whose curve is not found is missing, with the reason in `left_out`.
struct FrictionDependences {
  std::map<std::string, FrictionDependence> coefficients;
  std::map<std::string, double> constants;  ///< the same in all tables: no curve is needed
  std::vector<std::string> left_out;
};
FrictionDependences fit_friction_dependences(std::span<const continuum::RheologyTable> tables);

/// The table of grains in between: coefficients from the curves, errors from how far the curves
/// miss tables they were not fitted to. `like`: a table with the same closure and coefficients;
/// throws FitError where one of them has neither curve nor constant.
continuum::RheologyTable interpolate(const FrictionDependences& curves,
                                     const continuum::RheologyTable& like,
                                     double contact_friction);

}  // namespace grainlaw::calibration
