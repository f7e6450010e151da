#pragma once

#include <span>

#include "calibration/bootstrap.h"
#include "calibration/fittable_law.h"
#include "calibration/material_fit.h"

namespace grainlaw::calibration {

/// Bands of both laws of homogeneous flow at the given states.
struct MaterialBand {
  BootstrapBand friction;
  BootstrapBand volume_fraction;
};

/// Every replicate resamples the steady frames of all runs in moving blocks, as long as the slower
/// of mu and phi takes to forget, and fits both laws anew with the terms and weights of `fit`.
/// Where points scatter about a law by more than their errors the band is wider by the same factor,
/// as the errors of the coefficients are. Throws FitError where a fitted point has no run with
/// frames, or no replicate can be fitted.
MaterialBand material_band(std::span<const dem::LocalData> runs,
                           std::span<const StatePoint> points,
                           const MaterialFit& fit,
                           std::span<const State> states,
                           const BootstrapOptions& options = {});

}  // namespace grainlaw::calibration
