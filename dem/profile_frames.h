#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace grainlaw::dem {

/// Sums over the grains and contacts of one bin, from which every field follows. They are additive:
/// frames can be joined in any way afterwards. Bin and time averages, per unit volume.
struct BinMoments {
  double mass = 0.0;                       ///< density [mass/length^3]
  std::array<double, 3> momentum{};        ///< density of x, y, z momentum
  std::array<double, 6> momentum_flux{};   ///< sum m v v / V: xx yy zz xy xz yz
  double mass_offset = 0.0;                ///< sum m (z - zc) / V, zc the centre of the bin
  double mass_offset_squared = 0.0;        ///< sum m (z - zc)^2 / V
  double momentum_offset = 0.0;            ///< sum m (z - zc) v_x / V
  std::array<double, 6> contact_stress{};  ///< xx yy zz xy xz yz, compression positive (so xz is
                                           ///< negative in a chute): force times branch vector,
                                           ///< exact share of each bin
  double contacts = 0.0;  ///< number density of grain-contact incidences (each counted per grain)
};

/// sum += factor * moments.
void add_scaled(BinMoments& sum, const BinMoments& moments, double factor);

/// Averages over one stretch of time.
struct ProfileFrame {
  double begin = 0.0;  ///< [time]
  double end = 0.0;    ///< [time]
  int samples = 0;
  double centre_of_mass = 0.0;  ///< mean height of the flowing grains [length]
  double kinetic_energy = 0.0;  ///< of the flowing grains, translation and rotation, per grain
  std::vector<BinMoments> bins;
};

/// Profiles over z and time of one run. Bin k covers [z_begin + k width, z_begin + (k+1) width].
struct ProfileFrames {
  double z_begin = 0.0;    ///< [length]; below zero: grains sit in the pockets of the base
  double bin_width = 1.0;  ///< [length]
  std::vector<ProfileFrame> frames;
  bool from_rest = true;  ///< the first frame begins with the start of the flow from rest

  double bin_centre(std::size_t k) const {
    return z_begin + (static_cast<double>(k) + 0.5) * bin_width;
  }
};

/// Mass-averaged flow velocity of a frame, sum momentum_x / sum mass [length/time].
double mean_velocity(const ProfileFrame& frame);

/// v_x of every bin of one frame, NaN where the bin is empty.
std::vector<double> velocities(const ProfileFrame& frame);

}  // namespace grainlaw::dem
