#include "dem/profile_frames.h"

#include <cmath>

namespace grainlaw::dem {

void add_scaled(BinMoments& sum, const BinMoments& moments, double factor) {
  sum.mass += factor * moments.mass;
  for (std::size_t k = 0; k < 3; ++k) sum.momentum[k] += factor * moments.momentum[k];
  for (std::size_t k = 0; k < 6; ++k) {
    sum.momentum_flux[k] += factor * moments.momentum_flux[k];
    sum.contact_stress[k] += factor * moments.contact_stress[k];
  }
  sum.mass_offset += factor * moments.mass_offset;
  sum.mass_offset_squared += factor * moments.mass_offset_squared;
  sum.momentum_offset += factor * moments.momentum_offset;
  sum.contacts += factor * moments.contacts;
}

double mean_velocity(const ProfileFrame& frame) {
  double mass = 0.0, momentum = 0.0;
  for (const BinMoments& bin : frame.bins) {
    mass += bin.mass;
    momentum += bin.momentum[0];
  }
  return momentum / mass;
}

std::vector<double> velocities(const ProfileFrame& frame) {
  std::vector<double> result;
  for (const BinMoments& bin : frame.bins) {
    result.push_back(bin.mass > 0.0 ? bin.momentum[0] / bin.mass : std::nan(""));
  }
  return result;
}

}  // namespace grainlaw::dem
