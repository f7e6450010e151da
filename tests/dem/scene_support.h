#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dem/scene.h"

namespace grainlaw::dem::test {

inline constexpr double few_roundings =
    4.0 * std::numeric_limits<double>::epsilon();  // a handful of roundings
inline constexpr double infinite = std::numeric_limits<double>::infinity();

inline double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

inline constexpr Hooke soft{.stiffness = 2e4, .damping = 16.26};
inline constexpr Hooke stiff{.stiffness = 2e5, .damping = 50.0};
inline constexpr Sliding rough{.coefficient = 0.5, .stiffness = 2.0 / 7.0 * 2e4, .damping = 0.0};

/// A scene of soft, rough grains in this geometry, in units of m, d, g.
inline Scene scene_in(const Geometry& geometry) {
  Scene scene;
  scene.normal = soft;
  scene.friction = rough;
  scene.geometry = geometry;
  return scene;
}

inline Scene small_chute() {
  return scene_in(Chute{.inclination = radians(23.0), .length = 4.0, .width = 4.0, .grains = 55});
}
inline Scene small_shear() {
  return scene_in(SimpleShear{.shear_rate = 0.1, .pressure = 10.0, .grains = 200});
}
inline Scene small_plane() {
  return scene_in(PlaneShear{.velocity = 1.0, .load = 10.0, .grains = 500});
}
inline Scene small_box() {
  return scene_in(BodyForceBox{.amplitude = 1.0, .pressure = 10.0, .grains = 500});
}
inline Scene small_cell() {
  return scene_in(SplitBottom{.rotation_rate = 0.01, .grains = 2000});
}

inline Chute& chute(Scene& scene) {
  return std::get<Chute>(scene.geometry);
}

inline std::string refusal(const Scene& scene) {
  try {
    validate(scene);
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

/// A message, and what spoils a scene so that validate() says it.
using Spoilt = std::pair<std::string, std::function<void(Scene&)>>;

inline void expect_refusals(const Scene& good, const std::vector<Spoilt>& bad) {
  EXPECT_EQ(refusal(good), "");
  for (const auto& [message, spoil] : bad) {
    Scene scene = good;
    spoil(scene);
    EXPECT_EQ(refusal(scene).substr(0, message.size()), message);
  }
}

template <class Shape>
Spoilt spoilt(const std::string& message, std::function<void(Shape&)> spoil) {
  return {message, [spoil](Scene& scene) { spoil(std::get<Shape>(scene.geometry)); }};
}

}  // namespace grainlaw::dem::test
