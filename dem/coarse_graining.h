#pragma once

#include <algorithm>
#include <array>
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
  Vec3 branch;               ///< from the centre of the second to that of the first [length]
  Vec3 force;                ///< on the first [force]
  double dissipation = 0.0;  ///< by dashpots and sliding [power]
  double sliding_dissipation = 0.0;  ///< [power]; 0: the contact does not slide
};

/// Along what profiles are taken, and the axes in which vectors are then seen.
enum class ProfileAxis {
  z,       ///< flow along x, gradient along z: chute, plane shear
  y,       ///< flow along x, gradient along y: periodic boxes
  radius,  ///< flow along the azimuth, gradient along the radius: ring cell; vectors have the
           ///< components azimuthal, axial, radial
};

/// Bins along the axis.
struct Bins {
  ProfileAxis axis = ProfileAxis::z;
  bool periodic = false;  ///< the last bin borders on the first
  double begin = 0.0;     ///< [length]
  double width = 1.0;     ///< [length]
  double area = 1.0;      ///< of a bin across the axis; ring cell: per radius [length^2]
  std::size_t count = 0;
  double shear_rate = 0.0;  ///< velocities are taken relative to v_x = shear_rate (y - middle)
                            ///< [1/time]

  double centre(std::size_t k) const { return begin + (static_cast<double>(k) + 0.5) * width; }
  double volume(std::size_t k) const {
    return area * width * (axis == ProfileAxis::radius ? centre(k) : 1.0);
  }
  double coordinate(const Vec3& position) const;
};

/// Azimuthal, axial and radial component of a vector at a place.
Vec3 cylindrical(const Vec3& place, const Vec3& v);

/// Adds samples of all moments up to the average over one frame. Grains are point masses at their
/// centres; a contact acts along its branch, each bin getting the share of the branch it holds
/// (Goldhirsch 2010). The branch of a contact with a frozen grain or a wall ends at the contact
/// point, where its force is that of a wall (Weinhart et al. 2012): above all such points sigma_zz
/// is the weight above, exactly, in the mean.
class FrameSampler {
 public:
  /// `friction`: contacts slide, and that is counted.
  explicit FrameSampler(std::size_t bins, bool friction = false);

  /// `bins` as they are now: those of a driven box move with it.
  void sample(const Bins& bins,
              const Particles& particles,
              const Dynamics& dynamics,
              const std::vector<ContactSample>& contacts);

  std::size_t bins() const { return frame_.bins.size(); }
  /// The average since the last call; begin and end are the caller's.
  ProfileFrame finish();

 private:
  void add_grain(const Bins& bins, const Vec3& position, const Vec3& velocity, double mass);
  void add_contact(const Bins& bins, const Particles& particles, const ContactSample& contact);
  void count_contact(const Bins& bins, double point, const ContactSample& contact);

  ProfileFrame frame_;
};

/// Shares of the stretch from s1 to s2 in every bin it meets, add(bin, share): they sum to 1, less
/// what lies outside all bins.
template <class Add>
void share_stretch(const Bins& bins, double s1, double s2, Add&& add) {
  const double low = (std::min(s1, s2) - bins.begin) / bins.width;
  const double high = (std::max(s1, s2) - bins.begin) / bins.width;
  const auto count = static_cast<long>(bins.count);
  const auto first = static_cast<long>(std::floor(low));
  const auto last = static_cast<long>(std::floor(high));
  for (long k = first; k <= last; ++k) {
    const long bin = bins.periodic ? (k % count + count) % count : k;
    if (bin < 0 || bin >= count) continue;
    const double begin = std::max(low, static_cast<double>(k));
    const double end = std::min(high, static_cast<double>(k) + 1.0);
    add(static_cast<std::size_t>(bin), high == low ? 1.0 : (end - begin) / (high - low));
  }
}

/// sum += factor * a: x y z.
inline void add_vector(std::array<double, 3>& sum, const Vec3& a, double factor) {
  sum[0] += factor * a.x;
  sum[1] += factor * a.y;
  sum[2] += factor * a.z;
}

/// sum += factor * a b, symmetric: xx yy zz xy xz yz.
inline void add_dyad(std::array<double, 6>& sum, const Vec3& a, const Vec3& b, double factor) {
  sum[0] += factor * a.x * b.x;
  sum[1] += factor * a.y * b.y;
  sum[2] += factor * a.z * b.z;
  sum[3] += factor * a.x * b.y;
  sum[4] += factor * a.x * b.z;
  sum[5] += factor * a.y * b.z;
}

/// sum += factor * a b: xx yy zz xy xz yz yx zx zy.
inline void add_tensor(std::array<double, 9>& sum, const Vec3& a, const Vec3& b, double factor) {
  sum[0] += factor * a.x * b.x;
  sum[1] += factor * a.y * b.y;
  sum[2] += factor * a.z * b.z;
  sum[3] += factor * a.x * b.y;
  sum[4] += factor * a.x * b.z;
  sum[5] += factor * a.y * b.z;
  sum[6] += factor * a.y * b.x;
  sum[7] += factor * a.z * b.x;
  sum[8] += factor * a.z * b.y;
}

}  // namespace grainlaw::dem
