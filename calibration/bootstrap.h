#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/fittable_law.h"
#include "calibration/material_fit.h"
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

/// The same run with its steady frames resampled in moving blocks as long as its independent ones;
/// rows are averaged anew. Throws FitError for a run without frames.
dem::LocalData resample(const dem::LocalData& run, std::uint64_t seed);

/// Band of mu(I) at the given I: every replicate resamples all runs and fits the law anew. No
/// assumption on the distribution of errors or the curvature of the law.
BootstrapBand friction_band(std::span<const dem::LocalData> runs,
                            const std::vector<double>& inertial_numbers,
                            const BootstrapOptions& options = {},
                            const RowSelection& selection = {});

/// Bands of both laws of simple shear at the given states.
struct MaterialBand {
  BootstrapBand friction;
  BootstrapBand volume_fraction;
};

/// Every replicate resamples the frames of all boxes in moving blocks and fits both laws anew, with
/// the terms and weights of `fit`. Where points scatter about a law by more than their errors the
/// band is wider by the same factor, as the errors of the coefficients are. Throws FitError where a
/// fitted point has no run with frames.
MaterialBand material_band(std::span<const dem::LocalData> runs,
                           std::span<const StatePoint> points,
                           const MaterialFit& fit,
                           std::span<const State> states,
                           const BootstrapOptions& options = {});

}  // namespace grainlaw::calibration
