// SPDX-License-Identifier: Apache-2.0
//
// How the depth of an object changes across a run of its pixels. An object is as deep as its mean
// depth says (shown_depth.cpp) in the middle only: at a silhouette, the view ray leaves it at once.
// With one depth for all pixels, the far side of a ball is the near side moved back, a box is a
// piece of a cone about the viewer, and both hide too much of what is beside them.
//
// - The shown half, turned by 180 degrees about the middle between the silhouettes, is the hidden
//   one. With f the depth from the shown half to the line between the silhouettes, the depth at a
//   pixel is f there and f at its counterpart:
//
//     turned(k) = f(k) + f(pixels - 1 - k)
//
// - The rest of the mean depth is that of hidden sides, which lie at a right angle to the shown
//   face that ends at the silhouette. A view ray that heads for such a side leaves through it:
//
//     hidden = (end - p) . m / (w . m)   for w . m > 0, else infinite
//
//   w is the direction of the view ray, and m the one in that face that leads out of the object.
#include "scene/solids/depth_across.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "math/infinity.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"

namespace ssdo {
namespace {

/// The way from `p` to a side that ends at `end`, in lengths of `ray`; `outward`, of any length,
/// leads out of the object through it.
float to_side(const glm::vec3& p, const glm::vec3& ray, const glm::vec3& outward,
              const glm::vec3& end) {
  const float heads = glm::dot(ray, outward);
  return heads > 0 ? std::max(glm::dot(end - p, outward), 0.0f) / heads : kInfinity;
}

}  // namespace

DepthAcross::DepthAcross(const Geometry& geometry, const WholeRun& run, const MeanDepth& mean)
    : geometry_(&geometry), run_(run), mean_(mean) {
  const Surfel first = pixel(0), last = pixel(run.pixels - 1);
  const glm::vec3 from = first.position, to = last.position, view = to_viewer(0.5f * (from + to)),
                  way = to - from, across = glm::normalize(way - glm::dot(way, view) * view);
  first_normal_ = first.normal, last_normal_ = last.normal;
  first_ = silhouette(first, -across), last_ = silhouette(last, across);
  chord_ = last_ - first_;
}

float DepthAcross::at(int k) const {
  const ViewRay own = view_ray(k), counterpart = view_ray(run_.pixels - 1 - k);
  const float turned = to_chord(own) + to_chord(counterpart),
              share = mean_.shown > mean_.most ? mean_.most / mean_.shown : 1;
  return share * std::max(turned, 0.0f) +
         std::min(std::max(mean_.most - mean_.shown, 0.0f), to_hidden_side(own));
}

float DepthAcross::to_chord(const ViewRay& r) const {
  const float square = glm::dot(r.section, r.section);
  if (!(square > 0)) return 0;
  return r.length * glm::dot(glm::cross(chord_, first_ - r.front), r.section) / square;
}

float DepthAcross::to_hidden_side(const ViewRay& r) const {
  return r.length *
         std::min(to_side(r.front, r.along, glm::cross(first_normal_, r.section), first_),
                  to_side(r.front, r.along, glm::cross(r.section, last_normal_), last_));
}

Surfel DepthAcross::pixel(int k) const { return geometry_->surfaces[index(k)]; }

DepthAcross::ViewRay DepthAcross::view_ray(int k) const {
  const auto& [x, y, z] = geometry_->surfaces.position;
  const std::size_t i = index(k);
  const bool orthographic = geometry_->camera.orthographic;
  const glm::vec3 front(x[i], y[i], z[i]), along = orthographic ? glm::vec3(0, 0, -1) : front;
  return {front, along, orthographic ? 1 : glm::length(along), glm::cross(chord_, along)};
}

glm::vec3 DepthAcross::to_viewer(const glm::vec3& p) const {
  return direction_to_viewer(p, geometry_->camera.orthographic);
}

glm::vec3 DepthAcross::silhouette(const Surfel& end, const glm::vec3& outward) const {
  const float px = run_.step_px * PixelFootprint(geometry_->camera).at(-end.position.z);
  return silhouette_beside(end, outward, to_viewer(end.position), px);
}

}  // namespace ssdo
