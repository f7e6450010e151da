#pragma once
#include <string_view>
namespace grainlaw::dem {
struct Hooke {
  static constexpr std::string_view name = "hooke";
  double stiffness = 0.0;  ///< k_n [mass/time^2]
  double damping = 0.0;    ///< gamma_n [1/time], times the reduced mass
};
}  // namespace grainlaw::dem
