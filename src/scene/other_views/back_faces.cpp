// SPDX-License-Identifier: Apache-2.0
//
// A picture from the camera of the frame in which front faces are culled shows where the solids of
// the frame end. It is recognised by where its surfaces are, not by its normals: only some
// renderers turn normals to the viewer.
//
// - Its rays are those of the frame: the same place (or, of orthographic cameras, the same
//   direction) and the same axes. Its size and its windows need not be the frame's; each pixel of
//   the frame takes the nearest pixel of the picture, and the point where its own view ray meets
//   the tangent plane there.
// - Where both show a surface, a good part of the picture lies behind the surfaces of the frame,
//   and next to nothing before them. A copy of the frame lies behind it nowhere; where things have
//   moved, some of them are nearer.
//
// A surface that coincides with the frame's is one that the frame sees from behind: a sheet, or the
// inside of a hull. It tells no thickness, so the guess stays. The guess also stays where there is
// no back face, or where the back face lies before the surface.
#include "scene/other_views/back_faces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();

/// Two cameras are the same if their images of points at the median distance differ by less than
/// this, in pixels.
constexpr double kSamePx = 0.5;

/// Surfaces coincide if they are no farther apart than kRoundings times the rounding of their P
/// plus kFootprints of the width of a pixel.
constexpr float kRoundings = 4, kFootprints = 0.1f;

/// Least share of the common pixels that lie behind the frame, and the most that lie before it, as
/// a share of those behind.
constexpr double kLeastBehind = 0.1, kMostBefore = 0.1;

/// Least cosine between a view ray and a normal at which the ray is intersected with the tangent
/// plane.
constexpr float kLeastFacingBack = 0.1f;

/// Whether the rays of a view are among those of the frame.
bool is_same_camera(const OtherView& view, const Geometry& frame) {
  const Camera &a = frame.camera, &b = view.camera;
  if (b.panorama || a.orthographic != b.orthographic) return false;
  const double focal = std::min(a.fx, a.fy);
  const double per_turn = a.orthographic ? focal * double(frame.median_depth) : focal;
  for (int c = 0; c < 3; ++c) {
    for (int r = 0; r < 3; ++r) {
      const double turned = std::abs(b.rotation[c][r] - (c == r ? 1 : 0));
      if (!(turned * per_turn < kSamePx)) return false;
    }
  }
  const double parallax = glm::length(b.origin) * focal / double(frame.median_depth);
  return a.orthographic || parallax < kSamePx;
}

class BackFaces {
 public:
  BackFaces(const OtherView& view, const Geometry& frame)
      : view_(view),
        shown_(*view.picture),
        surfaces_(view.surfels_in_frame()),
        frame_(frame),
        footprint_(frame.camera) {}

  std::optional<Plane<float>> find() const {
    Plane<float> out(frame_.surfaces.width, frame_.surfaces.height, kNowhere);
    std::atomic<std::size_t> common{0}, behind{0}, before{0};
    for_each_row(out.height, [&](int y) {
      std::size_t here = 0, farther = 0, nearer = 0;
      for (std::size_t i = out.index(0, y), end = i + std::size_t(out.width); i < end; ++i) {
        const Surfel& s = frame_.surfaces[i];
        const auto back = s.is_usable() ? shown_at(s.position) : std::nullopt;
        if (!back) continue;
        const float distance = distance_between(s, *back),
                    tolerance = kRoundings * (s.rounding + back->rounding) +
                                kFootprints * footprint_.at(-s.position.z);
        ++here;
        nearer += distance < -tolerance;
        if (!(distance > tolerance)) continue;
        ++farther;
        out[i] = distance;
      }
      common += here, behind += farther, before += nearer;
    });
    const bool recognised = behind > 0 && double(behind) >= kLeastBehind * double(common) &&
                            double(before) <= kMostBefore * double(behind);
    if (!recognised) return std::nullopt;
    return out;
  }

 private:
  /// What the view shows in the direction of a point.
  std::optional<Surfel> shown_at(const glm::vec3& p) const {
    const glm::dvec3 own = view_.camera.to_camera(glm::dvec3(p));
    if (!view_.camera.orthographic && !(own.z < 0)) return std::nullopt;
    const glm::dvec2 at = view_.camera.project(own);
    const double x = std::floor(at.x - shown_.window.x0), y = std::floor(at.y - shown_.window.y0);
    if (!(x >= 0 && y >= 0 && x < surfaces_.width && y < surfaces_.height)) return std::nullopt;
    const std::size_t i = surfaces_.index(int(x), int(y));
    return surfaces_.is_surface(i) ? std::optional(surfaces_[i]) : std::nullopt;
  }

  /// The distance along the view ray of `front` to the tangent plane of `back`.
  float distance_between(const Surfel& front, const Surfel& back) const {
    const glm::vec3 along = -direction_to_viewer(front.position, frame_.camera.orthographic),
                    way = back.position - front.position;
    const float distance = glm::dot(way, along), facing = glm::dot(back.normal, along);
    const glm::vec3 aside = way - distance * along;
    if (!(std::abs(facing) > kLeastFacingBack)) return distance;
    const float most = kSurfaceGap * view_.footprint(-front.position.z);
    return distance + std::clamp(glm::dot(back.normal, aside) / facing, -most, most);
  }

  const OtherView& view_;
  const OtherPicture& shown_;
  const Surfaces surfaces_;  ///< in the camera space of the frame
  const Geometry& frame_;
  PixelFootprint footprint_;
};

}  // namespace

std::optional<Plane<float>> find_back_faces(const OtherView& view, const Geometry& frame) {
  if (!is_same_camera(view, frame)) return std::nullopt;
  return BackFaces(view, frame).find();
}

void end_at_back_faces(Solids& solids, const std::vector<Plane<float>>& distances) {
  if (distances.empty()) return;
  const int w = solids.thickness.width, h = solids.thickness.height;
  if (solids.end.empty()) solids.end = Plane<Provenance>(w, h, Provenance::guessed);
  for_each_row(h, [&](int y) {
    for (std::size_t i = solids.end.index(0, y), end = i + std::size_t(w); i < end; ++i) {
      float nearest = kNowhere;
      for (const Plane<float>& distance : distances) nearest = std::min(nearest, distance[i]);
      if (!(nearest < kNowhere) || solids.end[i] == Provenance::measured) continue;
      solids.thickness[i] = nearest;
      solids.end[i] = Provenance::measured;
    }
  });
  // Where a surface is guessed to go on behind something it is as thick as where it is seen.
  for (SolidLayer& layer : solids.behind) {
    if (layer.thickness.empty()) continue;
    for_each_row(h, [&](int y) {
      for (std::size_t i = layer.provenance.index(0, y), end = i + std::size_t(w); i < end; ++i) {
        const int sender = layer.sender[i];
        if (layer.provenance[i] != Provenance::guessed || sender < 0) continue;
        if (solids.end_is_measured(std::size_t(sender)))
          layer.thickness[i] = solids.thickness[std::size_t(sender)];
      }
    });
  }
}

std::size_t count_back_faces(const Plane<float>& distances) {
  return std::size_t(std::count_if(distances.pixels.begin(), distances.pixels.end(),
                                   [](float distance) { return distance < kNowhere; }));
}

}  // namespace ssdo
