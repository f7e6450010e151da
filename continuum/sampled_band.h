#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "continuum/chute_1d.h"

namespace grainlaw::continuum {

struct BandSampling {
  int samples = 200;
  std::uint64_t seed = 1;  ///< the same seed gives the same draws on every machine
};

/// Velocity at one height z over the draws that flow.
struct SampledVelocity {
  double z = 0.0;          ///< [length]
  double deviation = 0.0;  ///< standard deviation [length/time]
  double lower = 0.0;      ///< 2.5 % of the draws are slower [length/time]
  double upper = 0.0;      ///< 2.5 % are faster [length/time]
};

/// The error band by drawing coefficients, beside that of linear propagation.
struct SampledBand {
  int samples = 0;
  int without_flow = 0;               ///< draws whose law has no steady flow here, or is none
  std::vector<SampledVelocity> rows;  ///< at the heights of the profile
  bool agrees = true;  ///< with velocity_error of the profile, in every row within the noise
  std::string text;    ///< that in words, and where they do not agree, why
};

/// Draws the coefficients from a normal distribution with the table's covariance and predicts each
/// draw anew: no step of this is linear. The profile must carry the band of add_error_band. A
/// standard deviation of n draws is known to 1 / sqrt(2 (n - 1)); four times that, and a draw
/// without flow, is disagreement. Rows below the surface whose band
/// reaches down to rest are not compared. Absent
/// without a covariance or a profile.
std::optional<SampledBand> sample_error_band(const SteadyChute& steady,
                                             const RheologyTable& table,
                                             const ChuteCase& chute,
                                             const BandSampling& sampling = {});

}  // namespace grainlaw::continuum
