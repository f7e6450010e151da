#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "dem/kernel.h"

namespace grainlaw::dem {

/// Sums over the grains and contacts of one bin, from which every field follows. They are additive:
/// bins and frames can be joined in any way afterwards. Bin and time averages, per unit volume.
/// Offsets are those of grain centres or contact points from the centre of the bin along the axis.
struct BinMoments {
  double mass = 0.0;                        ///< density [mass/length^3]
  std::array<double, 3> momentum{};         ///< density of x, y, z momentum
  std::array<double, 6> momentum_flux{};    ///< sum m v v / V: xx yy zz xy xz yz
  double mass_offset = 0.0;                 ///< sum m o / V, o the offset
  double mass_offset_squared = 0.0;         ///< sum m o^2 / V
  std::array<double, 3> momentum_offset{};  ///< sum m o v / V
  std::array<double, 9> contact_stress{};   ///< xx yy zz xy xz yz yx zx zy, force times branch
                                            ///< vector, exact share of each bin: compression
                                            ///< positive (so xz is negative in a chute)
  std::array<double, 3> wall_force{};       ///< of glued grains and walls on grains, at the contact
                                            ///< points [force/length^3]
  std::array<double, 3> wall_force_offset{};  ///< sum o f / V, o of the contact points
  double grains = 0.0;                        ///< number density of centres [1/length^3]
  double contacts = 0.0;  ///< number density of grain-contact incidences (each counted per grain)
  std::array<double, 6> fabric{};  ///< sum n n over the incidences, n the normal: xx yy zz xy xz yz
  double contact_points = 0.0;     ///< number density of contacts, at the contact points
  double dissipation = 0.0;        ///< of contacts, at the contact points [power/length^3]
};

/// What only grains with friction have.
struct SlidingMoments {
  double contact_points = 0.0;  ///< number density of contacts that slide [1/length^3]
  double dissipation = 0.0;     ///< by sliding, of all dissipation [power/length^3]
};

/// sum += factor * moments.
void add_scaled(BinMoments& sum, const BinMoments& moments, double factor);
void add_scaled(SlidingMoments& sum, const SlidingMoments& moments, double factor);

/// sum += factor * moments, of a bin whose centre lies at `shift` from that of the sum [length].
void add_shifted(BinMoments& sum, const BinMoments& moments, double shift, double factor);

/// Averages over one stretch of time.
struct ProfileFrame {
  double begin = 0.0;  ///< [time]
  double end = 0.0;    ///< [time]
  int samples = 0;
  double centre_of_mass = 0.0;  ///< mean height of the flowing grains [length]
  double kinetic_energy = 0.0;  ///< of the flowing grains, translation and rotation, per grain
  std::vector<BinMoments> bins;
  std::vector<SlidingMoments> sliding{};  ///< as many, or none: grains without friction
};

/// Profiles along an axis and over time of one run. Bin k covers [z_begin + k width, z_begin +
/// (k+1) width]; bins are finer than the rows of fields made of them.
struct ProfileFrames {
  double z_begin = 0.0;    ///< [length]; below zero: grains sit in the pockets of the base
  double bin_width = 1.0;  ///< [length]
  std::vector<ProfileFrame> frames;
  std::size_t bins_per_row = 1;
  bool periodic = false;  ///< the last bin borders on the first
  Kernel kernel{};        ///< of the fields
  bool from_rest = true;  ///< the first frame begins with the start of the flow from rest

  double bin_centre(std::size_t k) const {
    return z_begin + (static_cast<double>(k) + 0.5) * bin_width;
  }
  double row_width() const { return static_cast<double>(bins_per_row) * bin_width; }
  double row_centre(std::size_t k) const {
    return z_begin + (static_cast<double>(k) + 0.5) * row_width();
  }
};

/// Mass-averaged flow velocity of a frame, sum momentum_x / sum mass [length/time].
double mean_velocity(const ProfileFrame& frame);

/// v_x of every row of one frame, the mean over its bins; NaN where there is no grain.
std::vector<double> velocities(const ProfileFrame& frame, std::size_t bins_per_row);

}  // namespace grainlaw::dem
