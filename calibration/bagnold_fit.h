#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/fit_summary.h"
#include "calibration/model_choice.h"
#include "continuum/rheology_table.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// Which rows of a profile count.
struct RowSelection {
  double above_base = 1.0;       ///< rows closer than this to z = 0 are left out [d]
  double dilute_fraction = 0.9;  ///< rows with phi below this share of the bulk phi are left out
};

/// What is known of the grains beside the run.
struct BagnoldOptions {
  RowSelection rows = {};
  bool cohesive = false;           ///< look for a plug and fit tau_c
  std::optional<double> mu0 = {};  ///< friction of the material as I -> 0: gives c0 beside tau_c
};

/// The layer that moves without shear at the top of a cohesive flow.
struct Plug {
  double height = 0.0;                     ///< of its lower end [d]
  double thickness = 0.0;                  ///< up to the highest row that counts [d]
  dem::Estimate yield_stress_from_weight;  ///< tau_c = g sin(theta) M of the plug [stress]
};

/// The law fitted to part of the data, or with the base held.
struct BagnoldVariant {
  std::string data;        ///< "profile and pairs", "profile", "pairs"
  bool free_base = false;  ///< the no-slip height is fitted, not held at z = 0; pairs need none
  FitSummary summary;
  /// Xi = b / (a gd) at 1/4, 1/2 and 3/4 of the flowing height (Brewster eq. 10), with intervals.
  std::vector<FittedCoefficient> ratios;
};

/// One tilt described by the generalised Bagnold law, closure (A).
struct BagnoldFit {
  continuum::RheologyTable table;  ///< closure A with effective base, covariance, range, provenance
  FitSummary summary;              ///< free effective base
  FitSummary fixed_base_summary;   ///< same fit with u = 0 forced at z = 0, for comparison
  dem::Estimate ratio_mid_depth;   ///< Xi = b / (a gd) at half depth (Brewster eq. 10)
  dem::Estimate ratio_mid_depth_fixed;   ///< same with the no-slip height fixed at 0
  std::vector<BagnoldVariant> variants;  ///< both of them, profile alone twice, pairs alone
  /// Linear (a = 0), Bagnold (b = 0) and generalised law on the same data with the same weights;
  /// chi^2 and AICc count the independent data in the residuals, not the rows.
  std::vector<ModelScore> models;
  std::optional<Plug> plug;               ///< cohesive grains only
  std::optional<dem::Estimate> cohesion;  ///< c0 that belongs to tau_c, where mu0 is known [stress]
};

/// Fits a, b and the effective no-slip height jointly to the velocity profile (cancellation-free
/// form of Brewster eq. 9, velocity relative to measured bulk density) and to the pairs of shear
/// stress and shear rate; tau_c of cohesive grains where a plug is found, else it is left out.
/// Weights are the standard errors of the rows; errors of the coefficients come from the scatter of
/// all rows together over independent blocks of the run, since neighbouring rows are strongly
/// correlated. Throws FitError when the run is not steady, has fewer than 4 usable rows, or frames
/// for fewer than 4 blocks.
BagnoldFit fit_bagnold(const dem::LocalData& data, const BagnoldOptions& options = {});

/// c0 of a material tau = c0 + mu(I) p from the tau_c it shows on an incline, tau_c = c0 tan(theta)
/// / (tan(theta) - mu0): balance of forces where tau = tau_c and I = 0. mu0 < tan(theta).
dem::Estimate material_cohesion(const dem::Estimate& tau_c, double inclination, double mu0);

}  // namespace grainlaw::calibration
