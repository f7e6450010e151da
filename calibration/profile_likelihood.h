#pragma once

#include "calibration/least_squares.h"

namespace grainlaw::calibration {

/// Where chi^2, minimised over all other unknowns, stays within `rise` of its minimum: a 95 %
/// interval for rise = 1.96^2 and residuals of unit variance (Venzon and Moolgavkar 1988). Unlike
/// value +- error it holds where the law is curved in its unknowns. A side on which chi^2 does not
/// rise so far before the bound of the unknown ends there, otherwise at infinity. The covariance
/// says where to search. Weights stay those of the problem.
Interval profile_interval(const LeastSquaresProblem& problem,
                          const Minimum& minimum,
                          const Matrix& covariance,
                          int unknown,
                          double rise);

/// True where value +- error is not to be trusted: a correlation above 0.95 with another unknown,
/// or a value within 3 standard errors of zero.
bool needs_profile(const Minimum& minimum, const Matrix& covariance, int unknown);

}  // namespace grainlaw::calibration
