// SPDX-License-Identifier: Apache-2.0
//
// Along the view ray of a pixel, and along the tangent plane beyond the frame's border, points are
// asked for what the views know about them, near to far in steps that grow as distances do. Where a
// view looks through a point nothing is solid, and the guess ends. Where a view shows a surface,
// that one is measured.
#include "scene/further/carve.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel/tiles.h"
#include "scene/normals.h"
#include "scene/pixel_footprint.h"

namespace ssdo {
namespace {

/// Points lie farther apart by this factor each, the first one this many footprints away.
constexpr float kGrowth = 2, kFirst = 2;

/// No guess is asked for beyond so many times the distance to the farthest surface.
constexpr float kFarthest = 4;

/// Whether a view looks through a place that would be inside of something so wide.
bool is_empty(const std::vector<FurtherView>& views, const glm::vec3& p, float width) {
  return std::any_of(views.begin(), views.end(),
                     [&](const FurtherView& view) { return view.look(p, width) == Sight::empty; });
}

bool is_known(const std::vector<FurtherView>& views, const glm::vec3& p) {
  return std::any_of(views.begin(), views.end(),
                     [&](const FurtherView& view) { return view.look(p) != Sight::unknown; });
}

/// Whether a surface that goes on beyond the frame for `length` ends here: where a view looks
/// through it. Where one shows it the guess was right, and goes on beyond that view's picture too;
/// but a panorama has no border, so that it needs no guess from there on.
bool ends_beyond(const std::vector<FurtherView>& views, const glm::vec3& p, float length) {
  return is_empty(views, p, length) ||
         std::any_of(views.begin(), views.end(), [&](const FurtherView& view) {
           return view.closed && view.look(p) == Sight::surface;
         });
}

/// The distance of the first point on the way from `start` that `ends`, to within a tenth of it;
/// `most` if none does.
template <class Ends>
float first_on_way(const glm::vec3& start, const glm::vec3& direction, float first, float most,
                   const Ends& ends) {
  const auto ends_at = [&](float t) { return ends(start + t * direction, t); };
  for (float t = first; t < most; t *= kGrowth) {
    if (!ends_at(t)) continue;
    if (t == first) return t;
    float before = t / kGrowth, after = t;
    for (int i = 0; i < 3; ++i) {
      const float between = std::sqrt(before * after);
      (ends_at(between) ? after : before) = between;
    }
    return after;
  }
  return most;
}

class Carver {
 public:
  Carver(Solids& solids, const Geometry& frame, const std::vector<FurtherView>& views)
      : solids_(solids), frame_(frame), views_(views), footprint_(frame.camera) {
    for (const Surfel& s : frame.surfel.pixels)
      if (s.is_usable()) farthest_ = std::max(farthest_, kFarthest * glm::length(s.position));
  }

  void carve() {
    if (solids_.end.empty())
      solids_.end = Plane<Origin>(frame_.surfel.width, frame_.surfel.height, Origin::guessed);
    for_each_row(frame_.surfel.height, [&](int y) {
      for (int x = 0; x < frame_.surfel.width; ++x) {
        const std::size_t pixel = frame_.surfel.index(x, y);
        if (!frame_.surfel[pixel].is_usable()) continue;
        if (!solids_.end_is_measured(pixel) && shorten(solids_.thickness[pixel], pixel, 0))
          solids_.end[pixel] = Origin::measured;
        for (SolidLayer& layer : solids_.behind) carve_behind(layer, pixel);
      }
    });
    end_continuations();
  }

 private:
  float first_step(const Surfel& s) const { return kFirst * footprint_.at(-s.position.z); }

  glm::vec3 away_from_viewer(const Surfel& s) const {
    return -direction_to_viewer(s.position, frame_.camera.orthographic);
  }

  /// Ends a solid whose front lies `distance` behind what the pixel shows where a view looks
  /// through it. Whether one does.
  bool shorten(float& thickness, std::size_t pixel, float distance) const {
    const Surfel& s = frame_.surfel[pixel];
    const glm::vec3 along = away_from_viewer(s);
    const float most = std::min(thickness, farthest_);
    const glm::vec3 front = s.position + distance * along;
    const float end =
        first_on_way(front, along, first_step(s), most,
                     [&](const glm::vec3& p, float t) { return is_empty(views_, p, t); });
    if (end < most) thickness = end;
    return end < most;
  }

  void carve_behind(SolidLayer& layer, std::size_t pixel) const {
    if (layer.origin[pixel] != Origin::guessed) return;
    const float distance = layer.distance[pixel];
    if (!(distance < farthest_)) return;
    if (is_known(views_, point_behind(frame_, pixel, distance)))
      layer.distance[pixel] = std::numeric_limits<float>::infinity();
    else
      shorten(layer.thickness[pixel], pixel, distance);
  }

  /// How far what the border shows goes on beyond it.
  void end_continuations() {
    const int w = frame_.surfel.width, h = frame_.surfel.height;
    solids_.beyond = BorderOf<float>(w, h, std::numeric_limits<float>::infinity());
    const bool panorama =
        std::any_of(views_.begin(), views_.end(), [](const auto& view) { return view.closed; });
    const auto end = [&](int x, int y, const glm::vec2& outward) {
      const Surfel& s = frame_.surfel(x, y);
      if (!s.is_usable()) {
        // Nothing goes on there, and a panorama shows all that stands beyond.
        if (panorama) solids_.beyond.at(x, y) = 0;
        return;
      }
      // The direction in the tangent plane whose picture leads straight out of the frame: within
      // the plane through the viewer, the surface and a place beside it.
      const glm::vec3 to_viewer = direction_to_viewer(s.position, frame_.camera.orthographic);
      const glm::vec3 aside(outward.x, -outward.y, 0);
      const glm::vec3 across = aside - glm::dot(aside, to_viewer) * to_viewer;
      const glm::vec3 along =
          across * glm::dot(s.normal, to_viewer) - to_viewer * glm::dot(s.normal, across);
      const float length = glm::length(along);
      if (!(length > 0)) return;
      const float known =
          first_on_way(s.position, along / length, first_step(s), farthest_,
                       [&](const glm::vec3& p, float t) { return ends_beyond(views_, p, t); });
      if (known < farthest_) solids_.beyond.at(x, y) = known;
    };
    for (int x = 0; x < w; ++x) end(x, 0, {0, -1}), end(x, h - 1, {0, 1});
    for (int y = 0; y < h; ++y) end(0, y, {-1, 0}), end(w - 1, y, {1, 0});
  }

  Solids& solids_;
  const Geometry& frame_;
  const std::vector<FurtherView>& views_;
  PixelFootprint footprint_;
  float farthest_ = 0;
};

}  // namespace

void carve(Solids& solids, const Geometry& frame, const std::vector<FurtherView>& views) {
  if (!views.empty() && !solids.thickness.empty()) Carver(solids, frame, views).carve();
}

}  // namespace ssdo
