#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "dem/vec3.h"

namespace grainlaw::dem {

/// One of the 27 images of a grain, numbered so that it fits beside a grain index.
using Image = std::uint32_t;

/// A box that repeats along the axes with a period; period 0: open in that direction. A periodic
/// axis covers [0, period).
struct Box {
  Vec3 period;

  /// The nearest image of a point at -difference, as seen from the origin.
  Image nearest_image(const Vec3& difference) const {
    return image(difference.x, period.x) + 3 * image(difference.y, period.y) +
           9 * image(difference.z, period.z);
  }

  /// Where every image lies relative to the original.
  std::array<Vec3, 27> image_shifts() const {
    std::array<Vec3, 27> shifts;
    for (int k = 0; k < 27; ++k) {
      const int row = k / 3;
      const int layer = k / 9;
      shifts[k] = {(k % 3 - 1) * period.x, (row % 3 - 1) * period.y, (layer - 1) * period.z};
    }
    return shifts;
  }

  /// Displacement that brings a point into the box.
  Vec3 wrapping(const Vec3& p) const {
    return {back(p.x, period.x), back(p.y, period.y), back(p.z, period.z)};
  }

 private:
  static Image image(double difference, double length) {
    if (length == 0.0 || std::abs(difference) <= 0.5 * length) return 1;
    return difference > 0.0 ? 2 : 0;
  }
  static double back(double x, double length) {
    return length == 0.0 ? 0.0 : -length * std::floor(x / length);
  }
};

}  // namespace grainlaw::dem
