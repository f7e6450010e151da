#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/bagnold_fit.h"
#include "calibration/contact_series.h"
#include "dem/local_data.h"

namespace grainlaw::calibration {

/// The yield stress that one chute shows, with cohesion or, to see that it is none, without.
struct CohesivePoint {
  std::string name;
  std::string series;
  double attraction = 0.0;       ///< f_a, the largest of a pair [weights of a grain, m g]
  double inclination = 0.0;      ///< [rad]
  double layer_height = 0.0;     ///< H, the highest row that counts [d]
  std::optional<Plug> plug{};    ///< its thickness, and tau_c from its weight
  dem::Estimate yield_stress{};  ///< tau_c of stress-rate pairs [stress]; >= 0
  bool at_bound = false;         ///< of the pairs: they would have it below 0
  dem::Estimate cohesion{};      ///< c0 that belongs to it; NaN where mu0 is not known

  double flowing_height() const { return plug ? plug->height : layer_height; }
};

/// Is c0 one value for all tilts of a series?
struct PooledCohesion {
  std::string series;
  double attraction = 0.0;   ///< [m g]
  dem::Estimate cohesion{};  ///< c0, mean over the tilts weighted with their errors [stress]
  int tilts = 0;
  double chance = 1.0;  ///< that values of one c0 differ as much; NaN for one tilt
};

/// What chutes of several strengths of cohesion say together.
struct CohesionSeries {
  std::optional<dem::Estimate> mu0{};  ///< of mu(I) fitted to the chutes without cohesion
  std::vector<CohesivePoint> points;
  std::vector<PooledCohesion> pooled;  ///< by series and attraction, 0 left out
  std::vector<std::string> left_out;   ///< sentences
};

/// Fits tau - tau_c = a gd^2 + b gd to every run with tau_c free. mu0 comes from the runs without
/// attraction, where they have three tilts; c0 = tau_c (1 - mu0/tan(theta)) with the error of both.
/// Runs that cannot be fitted are named. Never throws FitError.
CohesionSeries cohesion_series(std::span<const SeriesRun> runs);

}  // namespace grainlaw::calibration
