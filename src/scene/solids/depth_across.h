// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "scene/geometry.h"
#include "scene/solids/shown_depth.h"

namespace ssdo {

/// How deep an object is along the view ray of each pixel of a run that is seen whole, in scene
/// units; see depth_across.cpp.
class DepthAcross {
 public:
  /// The run has at least two pixels, and its mean depth `mean.most` is finite.
  DepthAcross(const Geometry& geometry, const WholeRun& run, const MeanDepth& mean);

  /// At the k-th pixel of the run.
  float at(int k) const;

 private:
  /// The view ray of a pixel, from the front of the object on.
  struct ViewRay {
    glm::vec3 front, along;
    float length;       ///< of `along`, which need not be unit
    glm::vec3 section;  ///< across the plane of the chord and the ray
  };

  /// f of the head of depth_across.cpp, negative where the line is nearer than the surface.
  float to_chord(const ViewRay& ray) const;
  /// The length of a view ray to the nearer hidden side.
  float to_hidden_side(const ViewRay& ray) const;

  std::size_t index(int k) const {
    return std::size_t(std::ptrdiff_t(run_.first) + k * run_.stride);
  }
  Surfel pixel(int k) const;
  ViewRay view_ray(int k) const;
  glm::vec3 to_viewer(const glm::vec3& p) const;
  glm::vec3 silhouette(const Surfel& end, const glm::vec3& outward) const;

  const Geometry* geometry_;
  WholeRun run_;
  MeanDepth mean_;
  glm::vec3 first_normal_, last_normal_;
  glm::vec3 first_, last_, chord_;  ///< the silhouettes, and the way between them
};

}  // namespace ssdo
