#pragma once

#include <optional>
#include <vector>

#include "continuum/chute_1d.h"
#include "continuum/shear_band.h"

namespace grainlaw::continuum {

struct BandStartOptions {
  int cells = 200;
  double relative_tolerance = 1e-6;
  double time_limit = 0.0;  ///< [time]; 0: as long as it may need, and at least the last output
  std::vector<double> output_times{};  ///< ascending; snapshots wanted [time]
  double steady_residual = 1e-6;       ///< of max |du/dt| over the driving stress per mass
};

/// A band on its way from rest under a drive that is switched on at time 0.
struct BandStart {
  Answer answer;
  std::vector<Snapshot> snapshots;  ///< at the output times that were reached
  Profile final_profile;            ///< rows as those of ShearBand
  double end_time = 0.0;            ///< [time]
  double driving_stress = 0.0;      ///< at the end, as in ShearBand [stress]
  double driving_velocity = 0.0;    ///< [length/time]
  /// When the momentum came within 1 % of its final value to stay; absent unless steady [time]
  std::optional<double> time_to_steady{};
  /// The one of stress and velocity that was not given, relative to the steady quadrature, which
  /// knows nothing of the integration in time.
  double difference = 0.0;
  SolverStatistics statistics;
};

/// Start from rest of a plane shear or a body-force box by the local law: du/dt = f - dtau/dM over
/// the mass from the moving wall (box: from y = 0), elastic below yield as in YieldingLayer, by
/// CVODE. Normal stress and mass are those of the steady band, so a given height is that of the
/// steady flow. Second order in 1/cells but for the edge of the band, which lies inside a cell.
/// Without a steady flow the answer is that of shear_band. Throws like shear_band, and
/// std::invalid_argument for an annulus (the radius of its mass changes as it dilates) and for a
/// nonlocal amplitude (the equation of the fluidity in time has a time scale that no source gives).
BandStart start_band(const RheologyTable& table,
                     const ShearBandCase& band,
                     const BandStartOptions& options = {});

}  // namespace grainlaw::continuum
