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
struct NearLamp;

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
/// the mean being that over all its points, which are those of even `u` in the unit square. With
/// occluders each point counts as far as a ray to it, `distance` long, is open.
///
/// Suns come from model_light() in light.cpp, lamps from make_source() in lamps/lamp.h. light-inl.h
/// asks a new type lane by lane.
struct Source {
  virtual ~Source() = default;

  std::string name;         ///< of its layers; empty: a part of the environment
  glm::vec3 irradiance{0};  ///< over pi, of a surface for which received() is 1
  float held = 0;           ///< share of its light that spherical harmonics would keep in its place

  /// What it lights, 0..1 by pixel of the scene's geometry: the lamp's `receive`. Null: everything.
  std::shared_ptr<const Plane<float>> receivers;
  std::string receive;  ///< the text of that selection, by which other views know it

  /// The share of its light that the surface of a pixel takes, with nothing in its way.
  float taken_at(std::size_t pixel) const { return receivers ? (*receivers)[pixel] : 1.0f; }

  virtual float received(const glm::vec3& position, const glm::vec3& normal) const = 0;

  /// The point for `u`, in whatever form seen() takes: a place, the unit direction to one that is
  /// endlessly far, or `u` itself where the receiver decides how points are spread.
  virtual glm::vec3 point(const glm::vec2& u) const = 0;

  /// What of point() a receiver sees, and what of all of them.
  virtual SourcePoint seen(const glm::vec3& position, const glm::vec3& point) const = 0;
  virtual SourceCone cone(const glm::vec3& position) const = 0;

  /// This, if it is endlessly far: it looks the same from everywhere. Null: it is not.
  virtual const DistantSource* distant() const { return nullptr; }

  /// This, if it is such a lamp: they have functions for vectors. Null: it is not.
  virtual const NearLamp* near_lamp() const { return nullptr; }
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
