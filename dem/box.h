#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "dem/vec3.h"

namespace grainlaw::dem {

/// One of the 27 images of a grain, numbered so that it fits beside a grain index.
using Image = std::uint32_t;
inline constexpr Image own_image = 13;

/// Where an image lies and how it moves relative to the original, as a cache line like GrainState.
struct alignas(64) ImageShift {
  Vec3 position{};  ///< [length]
  double unused_after_position = 0.0;
  Vec3 velocity;  ///< [length/time]
  double unused_after_velocity = 0.0;
};

/// A box that repeats along the axes with a period; period 0: open in that direction. A periodic
/// axis covers [0, period). Under Lees-Edwards shear the image above in y is displaced and moves
/// along x; when the height changes it moves along y too.
struct Box {
  Vec3 period{};
  double offset = 0.0;       ///< of the image above, along x [length]
  Vec3 top_velocity{};       ///< of the image above [length/time]
  Vec3 half_top_velocity{};  ///< the same half a step before, at the time of half-step velocities
  double wedge = 0.0;        ///< angle of a section about z that repeats by rotation; 0: none [rad]

  /// The nearest image of a point at -difference, as seen from the origin.
  Image nearest_image(const Vec3& difference) const {
    const Image y = image(difference.y, period.y);
    const double x = difference.x - (static_cast<double>(y) - 1.0) * offset;
    return image(x, period.x) + 3 * y + 9 * image(difference.z, period.z);
  }

  std::array<ImageShift, 27> image_shifts() const {
    std::array<ImageShift, 27> shifts;
    for (int k = 0; k < 27; ++k) {
      const int row = k / 3 % 3 - 1;
      const int layer = k / 9 - 1;
      shifts[k].position = {
          (k % 3 - 1) * period.x + row * offset, row * period.y, layer * period.z};
      shifts[k].velocity = static_cast<double>(row) * top_velocity;
    }
    return shifts;
  }

  double volume() const { return period.x * period.y * period.z; }

 private:
  static Image image(double difference, double length) {
    if (length == 0.0 || std::abs(difference) <= 0.5 * length) return 1;
    return difference > 0.0 ? 2 : 0;
  }
};

/// Turned about z.
inline Vec3 turned(const Vec3& v, double cosine, double sine) {
  return {cosine * v.x - sine * v.y, sine * v.x + cosine * v.y, v.z};
}
inline Vec3 turned(const Vec3& v, double angle) {
  return turned(v, std::cos(angle), std::sin(angle));
}

}  // namespace grainlaw::dem
