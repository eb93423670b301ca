// SPDX-License-Identifier: Apache-2.0
//
// Vectors, rotations and random numbers of the scene generator.
#pragma once

#include <cmath>
#include <random>

inline constexpr float kPi = 3.14159265f;

struct Vec {
  float x, y, z;
};
inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec operator*(Vec a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(Vec a, Vec b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Vec a) { return std::sqrt(dot(a, a)); }
inline Vec unit(Vec a) {
  const float l = length(a);
  return l > 0 ? a * (1 / l) : Vec{0, 0, 1};
}

/// A rotation, by the images of the three axes.
struct Rot {
  Vec a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  Vec operator*(Vec v) const { return a * v.x + b * v.y + c * v.z; }
  Rot operator*(const Rot& q) const { return {*this * q.a, *this * q.b, *this * q.c}; }
};
inline Rot about_z(float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
}
inline Rot about_x(float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {{1, 0, 0}, {0, c, s}, {0, -s, c}};
}
/// Axes whose third is the unit vector n.
inline Rot around(Vec n) {
  const Vec t = unit(cross(std::fabs(n.z) < 0.9f ? Vec{0, 0, 1} : Vec{1, 0, 0}, n));
  return {t, cross(n, t), n};
}

/// Random numbers of one scene. r(a, b) is uniform in a..b.
class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  float operator()(float a, float b) { return a + (b - a) * unit_interval(); }
  /// Uniform in the logarithm, for sizes.
  float log(float a, float b) { return a * std::exp(unit_interval() * std::log(b / a)); }
  /// Whole numbers a..b, both included.
  int count(int a, int b) { return a + static_cast<int>(engine_() % unsigned(b - a + 1)); }
  bool chance(float p) { return unit_interval() < p; }
  float sign() { return chance(.5f) ? 1.f : -1.f; }
  float angle() { return (*this)(0, 2 * kPi); }
  Vec direction() {
    const float z = (*this)(-1, 1), f = angle(), s = std::sqrt(1 - z * z);
    return {s * std::cos(f), s * std::sin(f), z};
  }
  Rot rotation() {
    const float a = angle(), b = angle(), c = angle();
    return about_z(a) * about_x(b) * about_z(c);
  }
  /// Diffuse colours: most are grey to weakly coloured, a tenth are saturated.
  Vec albedo() {
    const float v = log(.08f, .8f), s = chance(.1f) ? .8f : (*this)(0, .35f);
    return Vec{1 - s * unit_interval(), 1 - s * unit_interval(), 1 - s * unit_interval()} * v;
  }

  /// Floors and grounds: nearly grey.
  Vec floor_albedo() {
    const Vec c = albedo();
    const float grey = (c.x + c.y + c.z) / 3;
    return c * .3f + Vec{grey, grey, grey} * .7f;
  }

 private:
  // 24 bits of the generator, so that standard libraries agree.
  float unit_interval() { return static_cast<float>(engine_() >> 8) * (1.f / 16777216.f); }
  std::mt19937 engine_;
};
