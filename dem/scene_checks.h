#pragma once

#include <string>
#include <string_view>

#include "dem/scene.h"

namespace grainlaw::dem {

/// Where scene files state a number.
struct Place {
  std::string_view section;
  std::string_view key;
};

/// Throws a SceneError about this place.
[[noreturn]] void refuse(const Place& at, const std::string& message);
void require_positive(double value, const Place& at, std::string_view what);
void require_not_negative(double value, const Place& at, std::string_view what);

/// The parts of validate().
void check_laws(const Scene& scene);
void check_geometry(const Scene& scene);
void check_start(const Scene& scene);
void check_lifetimes(const Scene& scene);

/// The shortest half period of an undamped pair of the smallest grains, and its spring.
struct FastestMode {
  double time = 0.0;       ///< [time]
  std::string_view name;   ///< as messages call the spring
  double stiffness = 0.0;  ///< of the spring [mass/time^2]
};
FastestMode fastest_mode(const Scene& scene);

}  // namespace grainlaw::dem
