// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <string>

#include "math/plane.h"

namespace ssdo {

struct DistantLamp;
struct DistantSource;
struct LocalLamp;

/// A point of a source as a receiver sees it.
struct SourcePoint {
  glm::vec3 to{0};  ///< unit direction to it
  float distance = std::numeric_limits<float>::infinity();
  float weight = 1;  ///< see Source
};

/// The cone in which a receiver sees all of a source.
struct SourceCone {
  glm::vec3 to{0};  ///< unit direction to the middle
  float distance = std::numeric_limits<float>::infinity();
  float angular_radius = 0;  ///< radians; pi / 2 at most, as inside of the source
};

/// A concentrated source of light, of one colour, in the space of positions and normals. Without
/// occluders a surface at p with the normal n has from it
///
///   unoccluded(p, n) = irradiance received(p, n),   received = mean of weight max(0, cos)
///
/// where the mean is over the points of the source for uniform `u` in the unit square. With
/// occluders, each point counts by how open a ray to it, `distance` long, is.
///
/// Suns come from model_light() in light.cpp, lamps from make_source() in lamps/lamp.h. light-inl.h
/// evaluates a new type lane by lane.
struct Source {
  virtual ~Source() = default;

  std::string name;         ///< of its layers; empty: a part of the environment
  glm::vec3 irradiance{0};  ///< over pi, of a surface for which received() is 1
  float sh_fraction = 0;    ///< share of its light that spherical harmonics would keep in its place

  /// What it lights, 0..1 by pixel of the scene's geometry: the lamp's `receive`. Null: everything.
  std::shared_ptr<const Plane<float>> receivers;
  std::string receive;  ///< the text of that selection, by which other views know it

  /// The share of its light that reaches the surface of a pixel with nothing in its way.
  float link_weight(std::size_t pixel) const { return receivers ? (*receivers)[pixel] : 1.0f; }

  virtual float received(const glm::vec3& position, const glm::vec3& normal) const = 0;

  /// The point for `u`, in the form that seen() takes: a place, a unit direction if the source is
  /// endlessly far, or a place that seen() maps onto the source for each receiver.
  virtual glm::vec3 point(const glm::vec2& u) const = 0;

  /// What a receiver sees of point(), and of all points.
  virtual SourcePoint seen(const glm::vec3& position, const glm::vec3& point) const = 0;
  virtual SourceCone cone(const glm::vec3& position) const = 0;

  /// This source if it is a DistantSource; else null.
  virtual const DistantSource* distant() const { return nullptr; }

  /// This source if it is such a lamp, which has functions for vectors; else null.
  virtual const LocalLamp* local_lamp() const { return nullptr; }
  virtual const DistantLamp* distant_lamp() const { return nullptr; }

  SourcePoint sample(const glm::vec3& position, const glm::vec2& u) const {
    return seen(position, point(u));
  }
  glm::vec3 unoccluded(const glm::vec3& position, const glm::vec3& normal) const {
    return received(position, normal) * irradiance;
  }

 protected:
  Source() = default;
  Source(const Source&) = default;
  Source& operator=(const Source&) = default;
};

}  // namespace ssdo
