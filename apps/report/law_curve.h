#pragma once

#include <functional>
#include <vector>

#include "apps/report/report.h"

namespace grainlaw::report {

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

/// A number that follows from a table, with the standard error that the covariance of the table
/// gives to it (linear propagation); without a covariance the error is NaN.
dem::Estimate propagated(const continuum::RheologyTable& table,
                         const std::function<double(const continuum::RheologyTable&)>& number);

/// Names and standard errors of the coefficients of a table; NaN where it states none.
struct Coefficient {
  std::string name;
  dem::Estimate estimate;
};
std::vector<Coefficient> coefficients(const continuum::RheologyTable& table);

}  // namespace grainlaw::report
