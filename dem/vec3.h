#pragma once

#include <cmath>

namespace grainlaw::dem {

/// A vector of three components: along the flow, across it, normal to the base. S is double, or a
/// pack of doubles (simd.h) for as many vectors at once.
template <class S>
struct Vector3 {
  S x = S(0.0);
  S y = S(0.0);
  S z = S(0.0);

  constexpr Vector3& operator+=(const Vector3& b) {
    x += b.x, y += b.y, z += b.z;
    return *this;
  }
  constexpr Vector3& operator-=(const Vector3& b) {
    x -= b.x, y -= b.y, z -= b.z;
    return *this;
  }

  friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend constexpr Vector3 operator-(const Vector3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vector3 operator*(S s, const Vector3& a) { return {s * a.x, s * a.y, s * a.z}; }
};

using Vec3 = Vector3<double>;

constexpr bool operator==(const Vec3& a, const Vec3& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

template <class S>
constexpr S dot(const Vector3<S>& a, const Vector3<S>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
constexpr Vector3<S> cross(const Vector3<S>& a, const Vector3<S>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
constexpr S square(const Vector3<S>& a) {
  return dot(a, a);
}
inline double length(const Vec3& a) {
  return std::sqrt(square(a));
}

}  // namespace grainlaw::dem
