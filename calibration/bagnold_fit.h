#pragma once

#include "calibration/fit_summary.h"
#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// Which rows of a profile count.
struct RowSelection {
  double above_base = 1.0;       ///< rows closer than this to z = 0 are left out [d]
  double dilute_fraction = 0.9;  ///< rows with phi below this share of the bulk phi are left out
};

/// One tilt described by the generalised Bagnold law, closure (A).
struct BagnoldFit {
  continuum::RheologyTable table;  ///< closure A with effective base, covariance, range, provenance
  FitSummary summary;              ///< free effective base
  FitSummary fixed_base_summary;   ///< same fit with u = 0 forced at z = 0, for comparison
  dem::Estimate ratio_mid_depth;   ///< Xi = b / (a gd) at half depth (Brewster eq. 10)
  dem::Estimate ratio_mid_depth_fixed;  ///< same with the no-slip height fixed at 0
};

/// Fits a, b and the effective no-slip height jointly to the velocity profile (cancellation-free
/// form of Brewster eq. 9, velocity relative to measured bulk density) and to the pairs of shear
/// stress and shear rate; tau_c = 0 without cohesion. Weights are the standard errors of the rows;
/// errors of the coefficients come from the scatter of all rows together over independent blocks of
/// the run, since neighbouring rows are strongly correlated. Throws FitError when the run is not
/// steady, has fewer than 4 usable rows, or frames for fewer than 4 blocks.
BagnoldFit fit_bagnold(const dem::LocalData& data, const RowSelection& selection = {});

}  // namespace grainlaw::calibration
