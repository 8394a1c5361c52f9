#pragma once

#include <algorithm>
#include <cmath>

namespace hand_in_the_loop {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  Vec3& operator+=(const Vec3& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline double dot(const Vec3& a, const Vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(const Vec3& a) {
  return std::sqrt(dot(a, a));
}
inline double largest(const Vec3& a) {
  return std::max({a.x, a.y, a.z});
}
/// Rounds to the nearest multiple of `step`; 0: unchanged.
inline Vec3 inSteps(const Vec3& a, double step) {
  return step <= 0 ? a
                   : Vec3{step * std::round(a.x / step), step * std::round(a.y / step), step * std::round(a.z / step)};
}

}  // namespace hand_in_the_loop
