#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dem/packing.h"

namespace grainlaw::dem::test {

/// Largest overlap [mean diameter of the pair] that involves a mobile grain, every pair looked at;
/// image(p, k) is the k-th of `images` images of a point, the point itself included.
inline constexpr double rounding = 1e-12;  // of places in a box of some 10 d

template <class Image>
double worst_overlap(const std::vector<InitialGrain>& grains, int images, Image image) {
  double worst = 0.0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (grains[i].body != Body::none && grains[j].body != Body::none) continue;
      const double touching = 0.5 * (grains[i].diameter + grains[j].diameter);
      for (int k = 0; k < images; ++k) {
        const double distance = length(grains[i].position - image(grains[j].position, k));
        worst = std::max(worst, (touching - distance) / touching);
      }
    }
  }
  return worst;
}

inline double worst_overlap(const InitialState& state) {
  const auto shifts = state.box.image_shifts();
  return worst_overlap(
      state.grains, 27, [&](const Vec3& p, int k) { return p + shifts[k].position; });
}

inline double worst_overlap_in_sector(const std::vector<InitialGrain>& grains, double wedge) {
  return worst_overlap(grains, 3, [&](const Vec3& p, int k) { return turned(p, (k - 1) * wedge); });
}

inline std::vector<InitialGrain> part(const InitialState& state, Body body) {
  std::vector<InitialGrain> result;
  for (const InitialGrain& grain : state.grains) {
    if (grain.body == body) result.push_back(grain);
  }
  return result;
}

inline double solid_volume(const std::vector<InitialGrain>& grains) {
  double sum = 0.0;
  for (const InitialGrain& grain : grains) {
    sum += std::numbers::pi / 6.0 * std::pow(grain.diameter, 3);
  }
  return sum;
}

inline double highest_centre(const std::vector<InitialGrain>& grains) {
  return std::max_element(grains.begin(),
                          grains.end(),
                          [](const InitialGrain& a, const InitialGrain& b) {
                            return a.position.z < b.position.z;
                          })
      ->position.z;
}

inline double lowest_centre(const std::vector<InitialGrain>& grains) {
  return std::min_element(grains.begin(),
                          grains.end(),
                          [](const InitialGrain& a, const InitialGrain& b) {
                            return a.position.z < b.position.z;
                          })
      ->position.z;
}

inline std::vector<double> sorted_diameters(const std::vector<InitialGrain>& grains) {
  std::vector<double> result;
  for (const InitialGrain& grain : grains) result.push_back(grain.diameter);
  std::sort(result.begin(), result.end());
  return result;
}

inline bool covers(double period, double value) {
  return period == 0.0 || (value >= 0.0 && value < period);
}

inline bool inside_periods(const InitialState& state) {
  const Vec3& period = state.box.period;
  return std::all_of(state.grains.begin(), state.grains.end(), [&](const InitialGrain& g) {
    return covers(period.x, g.position.x) && covers(period.y, g.position.y) &&
           covers(period.z, g.position.z);
  });
}

inline bool at_rest(const std::vector<InitialGrain>& grains) {
  return std::all_of(grains.begin(), grains.end(), [](const InitialGrain& g) {
    return g.velocity == Vec3{} && g.rotation == Vec3{};
  });
}

inline Scene scene_of(Geometry geometry, double size_ratio = 1.0) {
  Scene scene;
  scene.geometry = std::move(geometry);
  scene.grains.size_ratio = size_ratio;
  scene.seed = 11;
  return scene;
}

inline Chute chute(int grains, Base base = BumpyBase{}) {
  Chute result;
  result.grains = grains;
  result.base = base;
  return result;
}

inline SimpleShear simple_shear(int grains) {
  SimpleShear result;
  result.shear_rate = 0.3;
  result.grains = grains;
  result.volume_fraction = 0.58;
  return result;
}

inline PlaneShear plane_shear(int grains) {
  PlaneShear result;
  result.velocity = 2.0;
  result.grains = grains;
  return result;
}

inline bool equal(const InitialState& a, const InitialState& b) {
  return std::equal(a.grains.begin(),
                    a.grains.end(),
                    b.grains.begin(),
                    b.grains.end(),
                    [](const InitialGrain& g, const InitialGrain& h) {
                      return g.position == h.position && g.diameter == h.diameter &&
                             g.body == h.body && g.velocity == h.velocity;
                    });
}

/// The packing of spheres of these diameters, as a state.
inline InitialState packing(const Box& box, const std::vector<double>& sizes, std::uint64_t seed) {
  InitialState state{.box = box, .grains = {}};
  const std::vector<Vec3> points = random_packing(box, sizes, seed);
  for (std::size_t k = 0; k < points.size(); ++k) {
    InitialGrain grain;
    grain.position = points[k];
    grain.diameter = sizes[k];
    state.grains.push_back(grain);
  }
  return state;
}

inline Box box_of(const Vec3& period) {
  Box box;
  box.period = period;
  return box;
}

inline Box cube_for(const std::vector<double>& sizes, double volume_fraction) {
  double sum = 0.0;
  for (const double diameter : sizes) sum += std::numbers::pi / 6.0 * std::pow(diameter, 3);
  const double edge = std::cbrt(sum / volume_fraction);
  return box_of({edge, edge, edge});
}

/// A small ring cell of unequal grains, 60 degrees of it.
inline SplitBottom small_ring() {
  return {.inner_radius = 4.0,
          .split_radius = 7.0,
          .outer_radius = 10.0,
          .wedge = std::numbers::pi / 3.0,
          .grains = 400};
}

}  // namespace grainlaw::dem::test
