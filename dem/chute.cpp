#include "dem/chute.h"

#include <algorithm>
#include <cmath>

namespace grainlaw::dem {
namespace {

constexpr double dense_fraction = 0.55;  // of a flowing layer, for estimates only

double depth(const Scene& scene) {
  return mass_per_area(scene) / (dense_fraction * scene.grains.density());
}

}  // namespace

Vec3 gravity(double strength, double inclination) {
  return {strength * std::sin(inclination), 0.0, -strength * std::cos(inclination)};
}

SimulationSetup chute_setup(const Scene& scene, const ChuteGrains& grains) {
  const double d = scene.grains.diameter;
  double lowest = 0.0;
  for (const Vec3& p : grains.base) lowest = std::min(lowest, p.z);
  return {.box = grains.box,
          .diameter = d,
          .dynamics = {.mass = scene.grains.mass,
                       .gravity = gravity(scene.geometry.gravity, 0.0),
                       .time_step = time_step(scene)},
          .max_overlap = scene.max_overlap,
          .lowest_height = lowest - 0.5 * d};
}

Bins chute_bins(const Scene& scene) {
  const double d = scene.grains.diameter;
  const double width = scene.measurement.bin_width;
  const double below = std::ceil((scene.geometry.base.thickness + 1.0) * d / width);
  const double above = std::ceil((1.4 * depth(scene) + 6.0 * d) / width);
  return {.z_begin = -below * width,
          .width = width,
          .area = scene.geometry.length * scene.geometry.width,
          .count = static_cast<std::size_t>(below + above)};
}

SteadyCriteria steady_criteria(const Scene& scene) {
  const Chute& chute = scene.geometry;
  const double d = scene.grains.diameter;
  const double unit_speed = std::sqrt(chute.gravity * d);
  const double fall = dense_fraction * chute.gravity * std::cos(chute.inclination);
  return {.averaging_time = scene.measurement.averaging_time,
          .rest_velocity = 1e-3 * unit_speed,
          .rest_time = 20.0 * std::sqrt(d / chute.gravity),
          .runaway_velocity = 0.4 * std::sqrt(fall) * std::pow(depth(scene), 1.5) / d};
}

}  // namespace grainlaw::dem
