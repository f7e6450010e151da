#pragma once

#include <optional>
#include <vector>

#include "calibration/comparison.h"
#include "calibration/nonlocal_fit.h"
#include "calibration/ring_band.h"
#include "continuum/ring_flow.h"

namespace grainlaw::calibration {

/// A measured ring cell beside the rotation a law predicts, in the cells that error functions were
/// fitted to: off cylinders, bottom and surface by the reach of the kernel.
struct RingComparison {
  dem::Estimate velocity;           ///< relative L2
  dem::Estimate velocity_maximum;   ///< largest |difference| over the largest measured velocity
  double in_standard_errors = 0.0;  ///< root mean square over the cells
  ErrorBudget budget;               ///< geometry: 0, the cell is the same on both sides
  std::vector<BandShape> rows;  ///< of the prediction, fitted like those of the DEM; in their order
};

/// With the covariance of the table the part of the law by linear propagation, a solution per
/// coefficient. Throws FitError where the prediction has no rotation.
RingComparison compare_ring(const RingBand& measured,
                            const continuum::RingFlow& predicted,
                            const continuum::RheologyTable& table,
                            const continuum::RingFlowCase& ring);

/// A of the nonlocal fluidity from the rotation of a ring cell, in cells twice the width of the
/// kernel apart; like fit_nonlocal_amplitude of a shear band.
NonlocalFit fit_nonlocal_amplitude(const continuum::RheologyTable& table,
                                   const continuum::RingFlowCase& ring,
                                   const RingBand& measured);

}  // namespace grainlaw::calibration
