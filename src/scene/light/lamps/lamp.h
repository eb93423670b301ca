// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>

#include "scene/light/source.h"
#include "scene/objects/selection.h"

namespace ssdo {

enum class LampType { sphere, disk, rect, distant };

/// What a user says of one lamp, in the space and unit of the world of P. The meaning is that of
/// UsdLux: a surface of the lamp has the radiance
///
///   color * temperature * intensity * 2^exposure
///
/// and with `normalize` that over the area of the lamp: 4 pi radius^2, pi radius^2, width * height,
/// or pi sin^2 of half the angle. Lamps emit along -z of their axes, spheres in all directions.
struct Lamp {
  std::string name;
  std::string given_by;  ///< for messages: "FILE: light NAME" or "--light NAME"
  LampType type = LampType::sphere;
  glm::dvec3 position{0};
  glm::dmat3 axes{1};            ///< columns: along the width, along the height, backwards
  double radius = 0.5;           ///< of a sphere or disk; a sphere of radius 0 is a point
  double width = 1, height = 1;  ///< of a rect
  double angle = 0.53;           ///< degrees across, of a distant lamp
  glm::dvec3 color{1};           ///< in the primaries of the frame
  glm::dvec3 temperature{1};     ///< colour of a black body, in linear Rec. 709 as read
  double intensity = 1, exposure = 0;
  bool normalize = false;
  bool soft_falloff = false;  ///< a sphere is the disk across it that faces each receiver
  double cone_angle = 90, cone_softness = 0;  ///< degrees off the axis; see Cone
  bool has_cone = false, cone_by_cosine = false;
  Selection receive;  ///< what it lights; empty: everything
  Selection cast;     ///< what blocks its light; empty: everything

  /// What `normalize` divides by; 1 for lamps without a size.
  double area() const;

  /// Radius of a ball about its position that holds the lamp.
  double reach() const;

  /// color * temperature * intensity * 2^exposure.
  glm::dvec3 value() const;
};

/// camera = rotation * (p - origin), as of a Camera; the rotation mirrors a left-handed world.
struct WorldToCamera {
  glm::dmat3 rotation{1};
  glm::dvec3 origin{0};
};

/// The light of a lamp in camera space. `nearest` is the smallest distance that can be resolved,
/// half a pixel: nearer receivers get no more light than at this distance. Source::receivers is
/// left to be set.
std::shared_ptr<Source> make_source(const Lamp& lamp, const WorldToCamera& camera, double nearest);

}  // namespace ssdo
