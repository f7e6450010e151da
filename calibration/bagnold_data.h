#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/observations.h"

namespace grainlaw::calibration {

/// The used rows of a run, or of one block of it, as the law sees them.
struct BagnoldData {
  std::vector<double> mass_above;
  std::vector<double> velocity;
  std::vector<double> shear_stress;
  std::vector<double> shear_rate;
  double density = 0.0;      ///< rho_p phi of the bulk
  double weight_down = 0.0;  ///< g sin(theta)
  double mass = 0.0;         ///< M0
};

/// Standard errors that weigh the residuals.
struct BagnoldErrors {
  std::vector<double> velocity;
  std::vector<double> shear_stress;
  std::vector<double> shear_rate;
};

/// Everything one run gives to the fits.
struct BagnoldInput {
  BagnoldData data;
  BagnoldErrors errors;
  std::vector<BagnoldData> blocks;
  std::array<double, 3> start{};  ///< a, b, mass below: the best Bagnold profile
  double mass_below_base = 0.0;   ///< flowing mass below z = 0, in the pockets of the base
};

/// Throws FitError where the velocity does not rise towards the surface.
BagnoldInput prepare(const dem::LocalData& run, const Observations& observations);

/// The rows at the top that hardly shear, where they are 3 d thick or more: gd below 5 % of the
/// fastest row, since gd fades gradually into a plug, or below 3 standard errors. The error of the
/// stress at the edge holds half a row and the choice of 2.5 or 10 % instead.
std::optional<Plug> find_plug(const dem::LocalData& run, const Observations& observations);

/// Takes the rows of the plug out, and says so.
void leave_out_plug(const dem::LocalData& run, const Plug& plug, Observations& observations);

}  // namespace grainlaw::calibration
