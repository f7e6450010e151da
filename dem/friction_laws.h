#pragma once
#include <string_view>
namespace grainlaw::dem {
struct Frictionless {
  static constexpr std::string_view name = "none";
};
struct Sliding {
  static constexpr std::string_view name = "sliding";
  double coefficient = 0.0;           ///< mu_p
  double stiffness = 0.0;             ///< k_t [mass/time^2]
  double damping = 0.0;               ///< gamma_t [1/time], times the reduced mass
};
}  // namespace grainlaw::dem
