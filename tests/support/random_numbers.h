// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <random>

namespace ssdo::test {

/// Numbers that follow from a seed, the same with every library. With every compiler too where each
/// is drawn in a statement or initialiser of its own: arguments are evaluated in any order.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : bits_(seed) {}

  std::uint64_t bits() { return bits_(); }

  /// In [0, 1).
  double unit() { return double(bits() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }

  /// Each power of two is as likely as the next; 0 < low.
  double by_ratio(double low, double high) { return low * std::pow(high / low, unit()); }

  /// From low to high, both included.
  int whole(int low, int high) { return low + int(bits() % std::uint64_t(high - low + 1)); }
  bool chance(double share) { return unit() < share; }

  template <class T>
  T one_of(std::initializer_list<T> all) {
    return *(all.begin() + whole(0, int(all.size()) - 1));
  }

  /// Unit, evenly over the sphere.
  glm::dvec3 direction() {
    const double z = between(-1, 1), azimuth = between(0, 2 * glm::pi<double>()),
                 r = std::sqrt(1 - z * z);
    return {r * std::cos(azimuth), r * std::sin(azimuth), z};
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace ssdo::test
