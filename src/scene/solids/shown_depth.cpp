// SPDX-License-Identifier: Apache-2.0
//
// The depth of an object, by the sides of it that a frame shows and by those that should be seen
// but are not. All is computed in the plane through the viewer and a line of the picture: the
// object is a section there, and its visible part a curve from one silhouette to the other.
//
// - Boxes, boards, posts, balls: their hidden half is the shown one, turned by 180 degrees about
//   the middle between the silhouettes. So the section has twice the area between the curve and
//   its chord. That area over the width across the view is its mean depth:
//
//     shown = 2 area / width
//
// - A flat front shows no depth. But where it comes nearer to the viewer towards a silhouette, a
//   side at a right angle to it would be seen there. In the picture, this side would be as wide as
//   its depth times v . m, where v is the unit direction to the viewer, and m the one away from the
//   front, in its plane and normal to the edge. It is not seen, so it is narrower than a pixel, by
//   half a pixel in the mean:
//
//     unseen = pixel / (2 v . m)   for v . m > 0, else infinite
//
//   The surface beyond the silhouette has to lie deeper than that, or else it would hide the side.
//   The direction of the edge is uncertain by a pixel over its length, which lowers the cosine v .
//   m.
//
// The depth is shown + unseen. So a board is thin if one of its sides should be seen but is not,
// and a box that shows a side is as deep as the side is long. The depth of a box that is seen
// face-on, or of a ball, stays unknown. Only two parallel silhouettes belong together: a line
// across the corner of a box enters it by one side and leaves it by the next.
#include "scene/solids/shown_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "math/infinity.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"
#include "scene/solids/width_of_run.h"

namespace ssdo {
namespace {

/// A round object, whose mean depth is pi / 4 of its width, keeps the depth guessed from its width.
constexpr float kRoundThing = kDepthOfWidth / (std::numbers::pi_v<float> / 4);

/// Least cosine between the view ray and a normal by which a surface is extended over half a pixel.
constexpr float kLeastCosine = 0.05f;

/// Two silhouettes are parallel from the first cosine between them on, and not parallel below the
/// second: 16 and 26 degrees. Edges that are some tens of pixels long are known to a few degrees;
/// those of tapered legs differ by up to ten. Chosen with a box of the truth scene `props` in view:
/// synthetic scenes give the same results with 26 and 45 degrees.
constexpr float kParallel = 0.96f, kCrossing = 0.9f;

/// Long runs are sampled at about so many pixels, and at each of those next to their ends, where
/// the sides may be narrow.
constexpr int kSamples = 64, kNextToEnd = 4;

/// An end of a run: half a pixel beyond its last pixel, where the silhouette is in the mean.
struct End {
  glm::vec3 position;
  float px;       ///< width of a pixel there
  Surfel beyond;  ///< the next pixel
  const glm::vec3& edge;
};

/// What a run shows, with its section in pixels.
class Section {
 public:
  Section(const Geometry& geometry, const WholeRun& run)
      : geometry_(geometry),
        run_(run),
        footprint_(geometry.camera),
        middle_(0.5f * (at(0).position + at(run.pixels - 1).position)),
        px_(pixel_at(middle_)),
        view_(to_viewer(middle_)),
        across_(across()),
        first_(end(0, -across_)),
        last_(end(run.pixels - 1, across_)) {}

  MeanDepth depth() const {
    const glm::vec3 chord = (last_.position - first_.position) / px_;
    const float width = glm::dot(chord, across_);
    // Not-a-number where both ends are at one position.
    if (!(width > 0)) return {};
    const float per_width = px_ / width, shown = per_width * kRoundThing * twice_area(chord);
    if (run_.lines == 0 || !(parallel() > 0)) return {kInfinity, shown};
    const float side = std::min(unseen(first_, -chord), unseen(last_, chord)) / parallel();
    return {shown + per_width * side * glm::length(chord), shown};
  }

 private:
  Surfel at(int i) const { return geometry_.surfaces[pixel(i)]; }
  std::size_t pixel(int i) const {
    return std::size_t(std::ptrdiff_t(run_.first) + i * run_.stride);
  }
  glm::vec3 to_viewer(const glm::vec3& p) const {
    return direction_to_viewer(p, geometry_.camera.orthographic);
  }
  float pixel_at(const glm::vec3& p) const { return run_.step_px * footprint_.at(-p.z); }

  /// Along the line of the picture.
  glm::vec3 across() const {
    const glm::vec3 way = (at(run_.pixels - 1).position - at(0).position) / px_;
    return glm::normalize(way - glm::dot(way, view_) * view_);
  }

  End end(int i, const glm::vec3& outward) const {
    const Surfel& s = at(i);
    const glm::vec3 view = to_viewer(s.position);
    const float px = pixel_at(s.position);
    return {silhouette_beside(s, outward, view, px), px, at(i == 0 ? -1 : run_.pixels),
            i == 0 ? run_.first_edge : run_.last_edge};
  }

  /// How surely the silhouettes are parallel, 0..1.
  float parallel() const {
    const float cosine = std::abs(glm::dot(run_.first_edge / px_, run_.last_edge / px_)) /
                         (glm::length(run_.first_edge / px_) * glm::length(run_.last_edge / px_));
    return std::clamp((cosine - kCrossing) / (kParallel - kCrossing), 0.0f, 1.0f);
  }

  /// The mean depth, in pixels, of a side at this end that is too narrow to be seen; `outward`
  /// leads here from the other end.
  float unseen(const End& end, const glm::vec3& outward) const {
    const glm::vec3 view = to_viewer(end.position), edge = glm::normalize(end.edge / px_),
                    normal_to_edge = glm::normalize(outward - glm::dot(outward, edge) * edge);
    const float doubt = std::abs(glm::dot(view, edge)) / float(run_.lines),
                seen = glm::dot(view, normal_to_edge) - doubt;
    if (!(seen > 0)) return kInfinity;
    const float side = 0.5f * end.px / px_ / seen;
    if (!end.beyond.is_surface()) return side;
    const glm::vec3 along = glm::normalize(outward),
                    to_front = glm::normalize(view - glm::dot(view, along) * along);
    const float room = glm::dot(end.position - end.beyond.position, to_front) / px_;
    return side < room ? side / std::min(1.0f, 2 - 2 * side / room) : kInfinity;
  }

  /// Twice the area between the curve and its chord, in square pixels.
  float twice_area(const glm::vec3& chord) const {
    const int step = std::max(1, run_.pixels / kSamples), near_last = run_.pixels - kNextToEnd;
    glm::vec3 sum(0), before(0);
    for (int i = 0; i < run_.pixels;) {
      const glm::vec3 here = (at(i).position - first_.position) / px_;
      sum += glm::cross(here, before), before = here;
      const bool is_next_to_end = i < kNextToEnd || i >= near_last;
      i = is_next_to_end ? i + 1 : std::min(i + step, near_last);
    }
    sum += glm::cross(chord, before);
    return std::max(glm::dot(sum, glm::cross(across_, view_)), 0.0f);
  }

  const Geometry& geometry_;
  const WholeRun& run_;
  PixelFootprint footprint_;
  glm::vec3 middle_;
  float px_;  ///< width of a pixel in the middle
  glm::vec3 view_, across_;
  End first_, last_;
};

}  // namespace

glm::vec3 silhouette_beside(const Surfel& pixel, const glm::vec3& outward,
                            const glm::vec3& to_viewer, float px) {
  const float facing = std::max(glm::dot(pixel.normal, to_viewer), kLeastCosine),
              nearer = -glm::dot(outward, pixel.normal) / facing;
  return pixel.position + 0.5f * px * (outward + nearer * to_viewer);
}

MeanDepth shown_depth(const Geometry& geometry, const WholeRun& run) {
  return run.pixels > 1 ? Section(geometry, run).depth() : MeanDepth{};
}

float least_depth(const Geometry& geometry, std::size_t pixel) {
  const Surfel& s = geometry.surfaces[pixel];
  const float cosine =
      glm::dot(s.normal, direction_to_viewer(s.position, geometry.camera.orthographic));
  // At silhouettes the slope has no limit: a pixel would stand for a wall.
  const float slope = std::sqrt(std::max(1 - cosine * cosine, 0.0f)) / std::max(cosine, 0.0f);
  return std::min(slope, kSurfaceGap) * PixelFootprint(geometry.camera).at(-s.position.z);
}

}  // namespace ssdo
