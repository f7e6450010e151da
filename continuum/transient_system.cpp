#include "continuum/transient_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace grainlaw::continuum {

double TransientSystem::largest_acceleration(std::span<const double> state,
                                             std::span<const double> rate) const {
  double largest = 0.0;
  for (std::size_t k = 0; k < cells(); ++k)
    largest = std::max(largest, std::abs(acceleration(state, rate, k)));
  return largest;
}

std::string TransientSystem::face_name(std::size_t face) const {
  return fmt::format(
      "the lower face of cell {} of {} (from the surface), mass above {:.4g} rho_p d",
      face + 1,
      cells(),
      grid().face[face]);
}

}  // namespace grainlaw::continuum
