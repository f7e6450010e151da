#pragma once

#include <cstddef>
#include <span>

#include "dem/estimate.h"

namespace grainlaw::dem {

/// Mean of an autocorrelated series and how well it is known.
struct BlockAverage {
  double mean = 0.0;
  double error = 0.0;              ///< standard error of the mean; NaN for fewer than 4 samples
  double correlation_time = 0.5;   ///< integrated, tau_int [samples]; 0.5 for independent samples
  double effective_samples = 0.0;  ///< N_eff = N / (2 tau_int)
  std::size_t block_length = 1;    ///< [samples]

  Estimate estimate() const { return {mean, error, effective_samples}; }
};

/// Block averaging (Flyvbjerg and Petersen 1989) with overlapping blocks, for less noise. Blocks
/// grow in steps of a sixteenth until their length B has B^3 > 2 N (2 tau_int(B))^2, which balances
/// the bias of short blocks against the noise of few (Lee et al. 2011); what bias is left at B is
/// corrected to first order. Blocks no longer than N / 4. docs/error_bars.md states how often the
/// intervals it gives hold the truth.
BlockAverage block_average(std::span<const double> series);

/// Degrees of freedom of the standard error of block_average, at least 1. n = (N_eff^2 / 2)^(1/3)
/// blocks, at least 4, fit into the series at the length chosen there; when they overlap their
/// variance is known as if to 3/2 (n - 1) degrees (Meketon and Schmeiser 1984), of which the
/// correction of the bias costs a part.
double degrees_of_freedom(double effective_samples);

/// Half-width of the interval about the value that holds the truth with a probability (0.95, say):
/// Student's t for the degrees of freedom of the blocks, of a normal distribution where N_eff is
/// not known.
double half_width(const Estimate& estimate, double probability);

/// Marginal standard error rule (White 1997): how many samples to cut from the start so that the
/// standard error of the rest, taken as independent, is smallest. At most half of the series.
std::size_t mser_truncation(std::span<const double> series);

/// Change of a straight line fitted to the series from its begin to its end, with its standard
/// error from the block average of what the line leaves.
struct Drift {
  double change = 0.0;
  double error = 0.0;
  double effective_samples = 0.0;
  /// Two-sided t test with N_eff - 2 degrees; never with < 3 samples. Those of the blocks would be
  /// fewer and find fewer drifts: a false alarm costs some time, a drift that is missed the result.
  bool significant(double probability) const;
  /// The largest size of the change that such a test leaves; NaN with < 4 samples.
  double most(double probability) const;
};
Drift linear_drift(std::span<const double> series);

/// Quantile of Student's t distribution, 0.5 < probability < 1, degrees >= 1. Between whole numbers
/// of degrees its logarithm is linear in their inverse: less than 3 % off.
/// Above 1000 degrees it is that of 1000.
double student_quantile(double probability, double degrees);

}  // namespace grainlaw::dem
