#pragma once

#include <cstddef>
#include <span>

namespace grainlaw::dem {

/// Mean of an autocorrelated series and how well it is known.
struct BlockAverage {
  double mean = 0.0;
  double error = 0.0;              ///< standard error of the mean; NaN for fewer than 4 samples
  double correlation_time = 0.5;   ///< integrated, tau_int [samples]; 0.5 for independent samples
  double effective_samples = 0.0;  ///< N / (2 tau_int)
  std::size_t block_length = 1;    ///< [samples]
  std::size_t blocks = 0;
  bool converged = false;  ///< at least 10 blocks remained at the chosen length
};

/// Block averaging (Flyvbjerg and Petersen 1989) with overlapping blocks, for less noise. The block
/// length B is the shortest with B^3 > 2 N (2 tau_int(B))^2, which balances the bias of short
/// blocks against the noise of few (Lee et al. 2011); what bias is left at B is corrected to first
/// order. Blocks no longer than N / 4.
BlockAverage block_average(std::span<const double> series);

/// Marginal standard error rule (White 1997): how many samples to cut from the start so that the
/// standard error of the rest, taken as independent, is smallest. At most half of the series.
std::size_t mser_truncation(std::span<const double> series);

/// Change of a straight line fitted to the series from its begin to its end, with its standard
/// error from the block average of what the line leaves.
struct Drift {
  double change = 0.0;
  double error = 0.0;
  double effective_samples = 0.0;
  bool significant(double probability) const;  ///< two-sided t test; never with < 3 samples
};
Drift linear_drift(std::span<const double> series);

/// Quantile of Student's t distribution, 0.5 < probability < 1, degrees >= 1.
double student_quantile(double probability, double degrees);

}  // namespace grainlaw::dem
