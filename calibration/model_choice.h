#pragma once

#include <string>
#include <vector>

namespace grainlaw::calibration {

/// One law among several fitted to the same data with the same weights.
struct ModelScore {
  std::string name = {};
  int coefficients = 0;
  double chi_squared = 0.0;
  double aicc = 0.0;
  bool chosen = false;
};

/// Akaike's criterion with the correction for few data, n ln(chi^2 / n) + 2 K + 2 K (K + 1) / (n -
/// K - 1) with K = coefficients + 1, as the scale of the errors is taken from the data too (Burnham
/// and Anderson 2002, eq. 7.3). Infinite where there are too few data to tell.
double corrected_akaike(double chi_squared, int data, int coefficients);

/// Probability that the larger of two nested laws is better by chance alone: F test on the fall of
/// chi^2 from `small` to `large` by extra coefficients. 1 without a fall, or without a degree of
/// freedom left to judge it by.
double chance_of_gain(const ModelScore& small, const ModelScore& large, int data);

/// Probability that F with (numerator, denominator) degrees of freedom exceeds a value >= 0.
double f_survival(double value, double numerator, double denominator);

/// Half-width of a 95 % interval in standard errors: 1.96 where the errors of the data are known,
/// Student's t where their scale was taken from the scatter about the law.
double interval_half_width(bool scale_from_scatter, int degrees_of_freedom);

}  // namespace grainlaw::calibration
