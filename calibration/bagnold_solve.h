#pragma once

#include <array>
#include <string>
#include <vector>

#include "calibration/bagnold_data.h"
#include "calibration/least_squares.h"

namespace grainlaw::calibration {

/// Unknowns of the generalised Bagnold law on a chute.
namespace bagnold_slot {
inline constexpr std::size_t a = 0, b = 1, tau_c = 2, mass_below = 3, count = 4;
}

/// What a fit rests on and which unknowns it has.
struct BagnoldForm {
  bool profile = true;  ///< velocities
  bool pairs = true;    ///< shear stress and shear rate
  std::array<bool, bagnold_slot::count> free{true, true, false, true};
  std::array<double, bagnold_slot::count> fixed{};  ///< values of those that are not free
};

/// Pairs of stress and shear rate alone; these know no base.
BagnoldForm stress_rate_pairs(bool yields);

/// The law at the minimum.
struct SolvedBagnold {
  BagnoldForm form;
  Minimum minimum;
  Uncertainty uncertainty;
  std::array<double, bagnold_slot::count> values{};
  double independent_data = 0.0;  ///< what the residuals are worth, (tr S)^2 / tr S^2
  int blocks = 0;

  int unknown(std::size_t slot) const;  ///< its place among the free ones; -1: fixed
};

/// Fits by effective variance with errors from the blocks of the run, which hold every correlation
/// between rows and between velocity, shear rate, stress and density.
SolvedBagnold solve_bagnold(const BagnoldInput& input, const BagnoldForm& form);

/// The same with the weights of another minimum, to compare laws on an equal footing.
Minimum solve_bagnold_weighted(const BagnoldInput& input,
                               const BagnoldForm& form,
                               const SolvedBagnold& weights);

/// Xi = b / (a gd) (Brewster et al. 2008, eq. 10) at a share of the height below the plug.
FittedCoefficient stress_ratio(const SolvedBagnold& solved,
                               const BagnoldInput& input,
                               double share_of_height);

}  // namespace grainlaw::calibration
