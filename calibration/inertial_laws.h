#pragma once

#include <vector>

#include "calibration/fit_summary.h"
#include "calibration/least_squares.h"
#include "calibration/mu_phi_fit.h"

namespace grainlaw::calibration {

/// Coefficients of a law in the order of summary.coefficients.
struct FittedLaw {
  std::vector<double> values;
  Matrix covariance;
  FitSummary summary;
};

/// One quantity of all points.
std::vector<dem::Estimate> collect(const std::vector<FlowPoint>& points,
                                   dem::Estimate FlowPoint::*quantity);

/// Number of different tilts among the points: only these are different points of a law.
int count_tilts(const std::vector<FlowPoint>& points);

/// mu0, beta and, where the data measure it, kappa of mu(I) by effective variance; the summary says
/// why kappa is not there. It needs more than three tilts and to differ from the linear law by two
/// standard errors. Throws FitError when friction does not rise with I.
FittedLaw fit_friction(const std::vector<FlowPoint>& points);

/// phi0 and I_phi of phi(I) by effective variance; a constant phi0 alone where no decrease with I
/// is measured.
FittedLaw fit_volume_fraction(const std::vector<FlowPoint>& points);

}  // namespace grainlaw::calibration
