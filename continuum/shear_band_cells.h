#pragma once

#include <optional>
#include <string>
#include <vector>

#include "continuum/nonlocal_fluidity.h"
#include "continuum/shear_band.h"

namespace grainlaw::continuum {

/// A band in units d = rho_p = 1.
struct BandProblem {
  MuPhi law;
  GrainProperties grains;
  std::variant<PlaneShear, BodyForceBox, AnnularShear> flow;
  double amplitude = 0.0;  ///< A; 0: local law

  FlowCurve curve(double pressure) const { return flow_curve(law, grains, pressure); }
};

/// d = rho_p = 1; the unit of time stays that of the case.
struct BandUnits {
  double length;
  double stress;  ///< rho_p d^2 / time^2
  double mass_per_area;

  explicit BandUnits(const GrainProperties& grains)
      : length(grains.diameter),
        stress(grains.density * grains.diameter * grains.diameter),
        mass_per_area(grains.density * grains.diameter) {}
};

/// Throws TableError and std::invalid_argument like shear_band.
BandProblem make_problem(const RheologyTable& table,
                         const ShearBandCase& band,
                         const BandUnits& units);

/// State of a cell; `along` is the distance from the moving wall, from y = 0 of the box, or r.
struct BandCell {
  double along = 0.0;
  double width = 0.0;
  double mass = 0.0;  ///< per unit area
  double shear_stress = 0.0;
  double pressure = 0.0;
  double shear_rate = 0.0;
  double volume_fraction = 0.0;

  double inertial_number() const;
};

/// Why there is no state at the stress asked for.
enum class BandFailure { none, no_steady, no_dense_state, not_converged };

/// Solution at one stress of the moving wall (of the box: at its own drive).
struct BandState {
  std::vector<BandCell> cells;  ///< from the moving wall to the wall at rest; box: a quarter period
  BandCell wall;                ///< at the moving wall; box: y = 0
  double velocity = 0.0;        ///< of the moving wall; of the box the largest
  double yielded_width = 0.0;
  int iterations = 0;
  BandFailure failure = BandFailure::none;
  std::string text;  ///< what failed where

  bool flows() const { return failure == BandFailure::none && velocity > 0.0; }
};

BandState band_state(const BandProblem& problem, double wall_stress, int cells);

/// Yield stress at the moving wall (box: the stress it yields at).
double wall_yield_stress(const BandProblem& problem);

/// d(velocity of the moving wall) across a cell per shear rate: width, in an annulus R_i width / r.
double velocity_weight(const BandProblem& problem, const BandCell& cell);

}  // namespace grainlaw::continuum
