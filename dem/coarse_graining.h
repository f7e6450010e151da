#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dem/integrator.h"
#include "dem/particles.h"
#include "dem/profile_frames.h"

namespace grainlaw::dem {

/// One contact as stress sees it.
struct ContactSample {
  std::uint32_t first;
  std::uint32_t second;
  Vec3 branch;  ///< from the centre of the second to that of the first [length]
  Vec3 force;   ///< on the first [force]
};

/// Bins of z over one base area.
struct Bins {
  double z_begin = 0.0;  ///< [length]
  double width = 1.0;    ///< [length]
  double area = 1.0;     ///< [length^2]
  std::size_t count = 0;

  double centre(std::size_t k) const { return z_begin + (static_cast<double>(k) + 0.5) * width; }
  double volume() const { return area * width; }
};

/// Adds samples of all fields up to the average over one frame. Grains are point masses at their
/// centres; a contact acts along its branch, each bin getting the share of the branch it holds
/// (Goldhirsch 2010; Weinhart et al. 2012, with a box in z as the kernel). The branch of a contact
/// with a frozen grain ends at the contact point: above all such points sigma_zz is the weight
/// above, exactly, in the mean.
class FrameSampler {
 public:
  explicit FrameSampler(const Bins& bins);

  void sample(const Particles& particles,
              const Dynamics& dynamics,
              const std::vector<ContactSample>& contacts);

  /// The average since the last call; begin and end are the caller's.
  ProfileFrame finish();

 private:
  void add_grain(const Vec3& position, const Vec3& velocity, double mass);
  void add_contact(const Particles& particles, const ContactSample& contact);

  Bins bins_;
  ProfileFrame frame_;
};

/// Shares of the stretch from z1 to z2 in every bin it meets, add(bin, share): they sum to 1, less
/// what lies outside all bins.
template <class Add>
void share_stretch(const Bins& bins, double z1, double z2, Add&& add) {
  const double low = (std::min(z1, z2) - bins.z_begin) / bins.width;
  const double high = (std::max(z1, z2) - bins.z_begin) / bins.width;
  const double last = static_cast<double>(bins.count) - 1.0;
  if (high < 0.0 || low >= last + 1.0) return;
  const auto first_bin = static_cast<std::size_t>(std::max(0.0, std::floor(low)));
  const auto last_bin = static_cast<std::size_t>(std::min(last, std::floor(high)));
  if (high == low) return add(first_bin, 1.0);
  for (std::size_t k = first_bin; k <= last_bin; ++k) {
    const double begin = std::max(low, static_cast<double>(k));
    const double end = std::min(high, static_cast<double>(k) + 1.0);
    add(k, (end - begin) / (high - low));
  }
}

}  // namespace grainlaw::dem
