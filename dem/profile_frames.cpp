#include "dem/profile_frames.h"

#include <bit>
#include <cmath>

namespace grainlaw::dem {
namespace {

template <class Moments>
void add_all(Moments& sum, const Moments& moments, double factor) {
  using Numbers = std::array<double, sizeof(Moments) / sizeof(double)>;
  auto numbers = std::bit_cast<Numbers>(sum);
  const auto added = std::bit_cast<Numbers>(moments);
  for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k] += factor * added[k];
  sum = std::bit_cast<Moments>(numbers);
}

}  // namespace

void add_scaled(BinMoments& sum, const BinMoments& moments, double factor) {
  add_all(sum, moments, factor);
}

void add_scaled(SlidingMoments& sum, const SlidingMoments& moments, double factor) {
  add_all(sum, moments, factor);
}

void add_shifted(BinMoments& sum, const BinMoments& moments, double shift, double factor) {
  add_scaled(sum, moments, factor);
  sum.mass_offset += factor * shift * moments.mass;
  sum.mass_offset_squared += factor * shift * (2.0 * moments.mass_offset + shift * moments.mass);
  for (std::size_t a = 0; a < 3; ++a) {
    sum.momentum_offset[a] += factor * shift * moments.momentum[a];
    sum.wall_force_offset[a] += factor * shift * moments.wall_force[a];
  }
}

double mean_velocity(const ProfileFrame& frame) {
  double mass = 0.0, momentum = 0.0;
  for (const BinMoments& bin : frame.bins) {
    mass += bin.mass;
    momentum += bin.momentum[0];
  }
  return momentum / mass;
}

std::vector<double> velocities(const ProfileFrame& frame, std::size_t bins_per_row) {
  std::vector<double> result;
  for (std::size_t k = 0; k + bins_per_row <= frame.bins.size(); k += bins_per_row) {
    double mass = 0.0, momentum = 0.0;
    for (std::size_t j = k; j < k + bins_per_row; ++j) {
      mass += frame.bins[j].mass;
      momentum += frame.bins[j].momentum[0];
    }
    result.push_back(mass > 0.0 ? momentum / mass : std::nan(""));
  }
  return result;
}

}  // namespace grainlaw::dem
