#pragma once

namespace grainlaw::dem {

/// The tilt of a chute from some time on.
struct TiltStep {
  double time = 0.0;         ///< since the start of the flow [time]
  double inclination = 0.0;  ///< [rad]

  bool operator==(const TiltStep&) const = default;
};

}  // namespace grainlaw::dem
