#pragma once

#include <limits>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "dem/estimate.h"

namespace grainlaw::calibration {

/// Xi = b / (a gd) of one run beside what it may depend on: the stiffness k_n d / (m g), or gd
/// tau_l of the contact lifetime tau_l.
struct RatioPoint {
  std::string name;
  double x = 0.0;
  dem::Estimate ratio;
};

/// Which points a law of Xi is fitted to; the others are named with the reason.
struct RatioRule {
  double least_significance = 2.0;  ///< Xi below so many standard errors is not detected
  double least_x = -std::numeric_limits<double>::infinity();
  double largest_x = std::numeric_limits<double>::infinity();
};

/// Two coefficients of Xi(x), each with its 95 % interval, and what was left out.
struct RatioLaw {
  FittedCoefficient factor;  ///< J, or c1
  FittedCoefficient rate;    ///< alpha, or c2
  FitSummary summary;        ///< of ln(factor) and rate
  std::vector<bool> used;    ///< per point
};

/// Xi = J x^alpha  (Brewster et al. 2008, eq. 11). Weighted straight line in the logarithms. Throws
/// FitError for fewer than 3 points at 2 different x that the rule lets through.
RatioLaw fit_ratio_power_law(const std::vector<RatioPoint>& points, const RatioRule& rule = {});

/// Xi = c1 exp(c2 x)  (Brewster et al. 2008, eq. 14).
RatioLaw fit_ratio_exponential(const std::vector<RatioPoint>& points, const RatioRule& rule = {});

}  // namespace grainlaw::calibration
