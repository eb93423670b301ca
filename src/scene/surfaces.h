// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "math/plane.h"
#include "parallel/planes.h"

namespace ssdo {

/// The piece of surface that a pixel shows, in camera space.
struct Surfel {
  static constexpr float kBackground = -2, kBroken = -1;  ///< as `rounding`: there is no surface

  glm::vec3 position{0};
  glm::vec3 normal{0};  ///< unit, on the viewer's side
  /// Distance by which the rounding of P as stored may have moved the position.
  float rounding = kBackground;

  /// Whether there is a surface.
  bool is_surface() const { return rounding >= 0; }

  /// Whether something is there that P does not place: it is not finite, or behind the camera.
  bool is_broken() const { return rounding == kBroken; }

  /// Whether methods can work with it: a surface in front of the viewer, whose position has a
  /// square with room for sums, with a normal of about unit length. Methods take all else for
  /// background.
  bool is_usable() const {
    constexpr float kNearest = 1e-15f, kFarthest2 = 1e30f;
    // Not-a-number is neither below nor above anything.
    return is_surface() && position.z < -kNearest && glm::dot(position, position) < kFarthest2 &&
           glm::dot(normal, normal) > 0.5f && glm::dot(normal, normal) < 2 &&
           rounding * rounding < kFarthest2;
  }
};

/// What the pixels of a picture show: the components of Surfel, a plane for each.
struct Surfaces {
  int width = 0, height = 0;
  std::array<Plane<float>, 3> position, normal;
  Plane<float> rounding;

  Surfaces() = default;

  /// The same in every pixel.
  Surfaces(int w, int h, const Surfel& surfel = {})
      : width(w), height(h), rounding(filled(w, h, surfel.rounding)) {
    for (int c = 0; c < 3; ++c) {
      position[std::size_t(c)] = filled(w, h, surfel.position[c]);
      normal[std::size_t(c)] = filled(w, h, surfel.normal[c]);
    }
  }

  /// Components that are whatever was in memory.
  static Surfaces unset(int w, int h) {
    Surfaces surfaces;
    surfaces.width = w, surfaces.height = h;
    surfaces.for_each_plane([&](Plane<float>& plane) { plane = Plane<float>::unset(w, h); });
    return surfaces;
  }

  bool empty() const { return rounding.empty(); }
  std::size_t size() const { return rounding.size(); }
  std::size_t index(int x, int y) const { return rounding.index(x, y); }

  bool is_surface(std::size_t i) const { return rounding[i] >= 0; }

  /// What a pixel shows. A const copy: an assignment to it, which would be lost, does not compile.
  const Surfel operator[](std::size_t i) const {  // NOLINT(readability-const-return-type)
    return {{position[0][i], position[1][i], position[2][i]},
            {normal[0][i], normal[1][i], normal[2][i]},
            rounding[i]};
  }
  const Surfel operator()(int x, int y) const {  // NOLINT(readability-const-return-type)
    return (*this)[index(x, y)];
  }

  void set_position(std::size_t i, const glm::vec3& p) {
    for (int c = 0; c < 3; ++c) position[std::size_t(c)][i] = p[c];
  }
  void set_normal(std::size_t i, const glm::vec3& n) {
    for (int c = 0; c < 3; ++c) normal[std::size_t(c)][i] = n[c];
  }
  void set(std::size_t i, const Surfel& surfel) {
    set_position(i, surfel.position);
    set_normal(i, surfel.normal);
    rounding[i] = surfel.rounding;
  }
  void set(int x, int y, const Surfel& surfel) { set(index(x, y), surfel); }

  /// Calls change(Surfel&) for every pixel.
  template <class Change>
  void change_each(const Change& change) {
    for (std::size_t i = 0; i < size(); ++i) {
      Surfel surfel = (*this)[i];
      change(surfel);
      set(i, surfel);
    }
  }

  /// Walks over what the pixels show, row by row.
  struct Iterator {
    const Surfaces* surfaces;
    std::size_t i;

    Surfel operator*() const { return (*surfaces)[i]; }
    Iterator& operator++() { return ++i, *this; }
    bool operator==(const Iterator&) const = default;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }

  /// Calls visit(Plane<float>&) for the planes.
  template <class Visit>
  void for_each_plane(const Visit& visit) {
    for (auto& plane : position) visit(plane);
    for (auto& plane : normal) visit(plane);
    visit(rounding);
  }
};

}  // namespace ssdo
