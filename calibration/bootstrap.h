#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

struct BootstrapOptions {
  int replicates = 200;
  double probability = 0.95;
  std::uint64_t seed = 1;
};

/// A band about a curve that holds it with a probability, point by point.
struct BootstrapBand {
  std::vector<double> lower;
  std::vector<double> upper;
  int replicates = 0;  ///< that could be fitted
  int failed = 0;      ///< that could not
};

/// A series resampled in blocks of `block` neighbours that start anywhere (Kuensch 1989): indices
/// into a series of `length`, as many as it is long.
std::vector<std::size_t> moving_blocks(std::size_t length, std::size_t block, std::uint64_t seed);

/// The value below which a share of the values lies, linear between them.
double quantile(std::vector<double> values, double share);

/// The same run with its steady frames resampled in moving blocks as long as its independent ones;
/// rows are averaged anew. Throws FitError for a run without frames.
dem::LocalData resample(const dem::LocalData& run, std::uint64_t seed);

/// Band of mu(I) at the given I: every replicate resamples all runs and fits the law anew. No
/// assumption on the distribution of errors or the curvature of the law.
BootstrapBand friction_band(std::span<const dem::LocalData> runs,
                            const std::vector<double>& inertial_numbers,
                            const BootstrapOptions& options = {},
                            const RowSelection& selection = {});

}  // namespace grainlaw::calibration
