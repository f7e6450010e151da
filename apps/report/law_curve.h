#pragma once

#include <vector>

#include "apps/report/report.h"

namespace grainlaw::report {

using calibration::propagated;

/// One point of the fitted curves mu(I), phi(I) with the standard errors its covariance gives.
struct LawPoint {
  double inertial_number = 0.0;
  dem::Estimate friction;
  dem::Estimate volume_fraction;
};

/// The law at one softness, without cohesion; the inertial numbers are spaced evenly.
/// Empty for closure (A), which has no mu(I).
std::vector<LawPoint> law_curve(const continuum::RheologyTable& table,
                                const continuum::Range& inertial_number,
                                double softness,
                                std::size_t points);

/// I at which mu(I, p*) is tan(theta); NaN where the law has no such I.
dem::Estimate inertial_number_at(const continuum::RheologyTable& table,
                                 double inclination,
                                 double softness);

/// Names and standard errors of the coefficients of a table; NaN where it states none.
struct Coefficient {
  std::string name;
  dem::Estimate estimate;
};
std::vector<Coefficient> coefficients(const continuum::RheologyTable& table);

}  // namespace grainlaw::report
