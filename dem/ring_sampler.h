#pragma once

#include <vector>

#include "dem/coarse_graining.h"
#include "dem/ring_grid.h"

namespace grainlaw::dem {

/// Fine bins over radius and height, equally wide, and the cells made of them.
struct RingBins {
  Bins radial;
  Bins axial;
  double wedge = 0.0;  ///< [rad]
  std::size_t bins_per_row = 1;
  Kernel kernel{};
};

/// Adds samples of all moments over a ring cell, and smooths them frame by frame with the kernel
/// along r times that along z: mass is spread, so that nothing is lost beyond the walls. The same
/// conventions as FrameSampler; summed over z it holds what that one holds.
class RingSampler {
 public:
  explicit RingSampler(const RingBins& bins);

  void sample(const Particles& particles,
              const Dynamics& dynamics,
              const std::vector<ContactSample>& contacts);
  const RingGrid& grid() const { return grid_; }
  /// The average since the last call.
  RingFrame finish();

 private:
  /// What a row or column of cells gets of a fine bin.
  struct Share {
    std::size_t row;
    double share;
    double shift;  ///< from the centre of the row to that of the bin [length]
  };
  std::vector<std::vector<Share>> shares(const Bins& bins) const;
  void add_grain(const Vec3& position, const Vec3& velocity, double mass);
  void add_contact(const Particles& particles, const ContactSample& contact);
  void spread(std::size_t radial, std::size_t axial, std::vector<CellMoments>& cells) const;

  RingBins bins_;
  RingGrid grid_;
  std::vector<std::vector<Share>> radial_shares_;
  std::vector<std::vector<Share>> axial_shares_;
  std::vector<CellMoments> fine_;  ///< [axial][radial]
  int samples_ = 0;
};

}  // namespace grainlaw::dem
