// SPDX-License-Identifier: Apache-2.0
//
// Points along the view ray of each pixel, and along the tangent plane beyond the frame's border,
// are looked up in the other views, near to far, in steps that grow with the distance. Where a view
// looks through a point, nothing is solid, and the guess ends.
//
// A surface that was guessed behind others is kept where views show a surface. It sends the light
// that the frame shows, and has no gaps, while the coarse triangles of a view show the ground only
// up to some pixels before the things on it. Without the guess, a cone on a lit ground got a
// quarter of the light from the ground.
#include "scene/other_views/carve.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/other_views/sight.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

/// Each point is kGrowth times as far away as the one before; the first is kFirst footprints away.
/// The room between an object and what is behind it is often less deep than the object: steps that
/// double the distance would pass over it.
constexpr float kGrowth = 1.25f, kFirst = 2;

/// Guesses are not tested beyond this many times the distance to the farthest surface.
constexpr float kFarthest = 4;

/// What the views know about the points of one line.
class SightLines {
 public:
  explicit SightLines(const std::vector<OtherView>& views) : views_(views) {}

  void aim(const glm::vec3& start, const glm::vec3& direction) {
    lines_.clear();
    for (const OtherView& view : views_) lines_.emplace_back(view, start, direction);
  }

  /// Whether a view looks through the point `t` behind `front`, inside a solid of that thickness. A
  /// view that looks through the front too is ignored: it shows another time, when the solid was
  /// elsewhere.
  bool is_empty(float front, float t) const {
    return std::any_of(lines_.begin(), lines_.end(), [&](const SightLine& line) {
      return line.at(front + t, t) == Sight::empty && line.at(front) != Sight::empty;
    });
  }

  /// Whether a view looks through the point, or past it in part.
  bool may_be_empty(float t) const {
    return std::any_of(lines_.begin(), lines_.end(), [&](const SightLine& line) {
      const Sight sight = line.at(t);
      return sight == Sight::empty || sight == Sight::rim;
    });
  }

  /// Whether a surface that continues beyond the frame along the line ends at `t`: where a view
  /// looks through it, or a panorama shows a surface. Another view that shows a surface there
  /// confirms the guess, which continues beyond the border of that view; a panorama has no border.
  bool ends_beyond(float t) const {
    if (is_empty(0, t)) return true;
    for (std::size_t k = 0; k < views_.size(); ++k)
      if (views_[k].picture->closed && lines_[k].shows_surface(t)) return true;
    return false;
  }

 private:
  const std::vector<OtherView>& views_;
  std::vector<SightLine> lines_;
};

/// The least distance for which `ends` is true, to within a tenth; `most` if there is none.
template <class Ends>
float first_on_way(float first, float most, const Ends& ends) {
  for (float t = first; t < most; t *= kGrowth) {
    if (!ends(t)) continue;
    if (t == first) return t;
    float before = t / kGrowth, after = t;
    for (int i = 0; i < 3; ++i) {
      const float between = std::sqrt(before * after);
      (ends(between) ? after : before) = between;
    }
    return after;
  }
  return most;
}

class Carver {
 public:
  Carver(Solids& solids, const Geometry& frame, const std::vector<OtherView>& views)
      : solids_(solids), frame_(frame), views_(views), footprint_(frame.camera) {
    for (const Surfel& s : frame.surfaces)
      if (s.is_usable()) farthest_ = std::max(farthest_, kFarthest * glm::length(s.position));
  }

  void carve() {
    solids_.separate_thicknesses();
    if (solids_.end.empty())
      solids_.end =
          Plane<Provenance>(frame_.surfaces.width, frame_.surfaces.height, Provenance::guessed);
    const int w = frame_.surfaces.width, h = frame_.surfaces.height;
    for_each_row((h + 1) / 2, [&](int block_y) {
      SightLines lines(views_);
      for (int x0 = 0; x0 < w; x0 += 2) {
        Ending known;
        for (int y = 2 * block_y; y < std::min(2 * block_y + 2, h); ++y)
          for (int x = x0; x < std::min(x0 + 2, w); ++x)
            carve_pixel(frame_.surfaces.index(x, y), known, lines);
      }
    });
    end_continuations();
  }

 private:
  float first_step(const Surfel& s) const { return kFirst * footprint_.at(-s.position.z); }

  /// The end of the solid that a pixel shows, searched up to the distance `asked`. Views are
  /// coarse: of each 2 x 2 pixels, those on one surface share the result.
  struct Ending {
    std::optional<Surfel> of;
    float asked = 0, end = 0;
  };

  bool holds_for(const Ending& known, const Surfel& s, float most) const {
    constexpr float kHardlyMore = 1.1f;
    return known.of && most <= kHardlyMore * known.asked &&
           on_one_surface({known.of->position, known.of->normal}, {s.position, s.normal},
                          footprint_);
  }

  void carve_pixel(std::size_t pixel, Ending& known, SightLines& lines) {
    const Surfel& s = frame_.surfaces[pixel];
    if (!s.is_usable()) return;
    const float first = first_step(s);
    bool aimed = false;
    const auto aim = [&] {
      if (!aimed)
        lines.aim(s.position, -direction_to_viewer(s.position, frame_.camera.orthographic));
      aimed = true;
    };
    if (!solids_.end_is_measured(pixel)) {
      float& thickness = solids_.thickness[pixel];
      const float most = std::min(thickness, farthest_);
      if (!holds_for(known, s, most)) {
        aim();
        known = {s, most, end_of(first, most, 0, lines)};
      }
      if (known.end < std::min(most, known.asked)) {
        thickness = known.end;
        solids_.end[pixel] = Provenance::measured;
      }
    }
    for (SolidLayer& layer : solids_.behind) {
      if (layer.provenance[pixel] != Provenance::guessed) continue;
      const float distance = layer.distance[pixel];
      if (!(distance < farthest_)) continue;
      aim();
      if (lines.may_be_empty(distance)) {
        layer.distance[pixel] = std::numeric_limits<float>::infinity();
        continue;
      }
      float& thickness = layer.thickness[pixel];
      const float most = std::min(thickness, farthest_), end = end_of(first, most, distance, lines);
      if (end < most) thickness = end;
    }
  }

  /// Where a solid whose front lies at `distance` on the lines ends because a view looks through
  /// it; `most` if no view does.
  float end_of(float first, float most, float distance, const SightLines& lines) const {
    return first_on_way(first, most, [&](float t) { return lines.is_empty(distance, t); });
  }

  /// Finds how far the surfaces at the border of the frame continue beyond it.
  void end_continuations() {
    const int w = frame_.surfaces.width, h = frame_.surfaces.height;
    solids_.beyond = BorderOf<float>(w, h, std::numeric_limits<float>::infinity());
    SightLines lines(views_);
    const auto end = [&](int x, int y, const glm::vec2& outward) {
      const Surfel& s = frame_.surfaces(x, y);
      if (!s.is_usable()) return;
      // The direction in the tangent plane that projects straight out of the frame: it lies in the
      // plane through the viewer, the surface point and a point beside it.
      const glm::vec3 to_viewer = direction_to_viewer(s.position, frame_.camera.orthographic);
      const glm::vec3 aside(outward.x, -outward.y, 0);
      const glm::vec3 across = aside - glm::dot(aside, to_viewer) * to_viewer;
      const glm::vec3 along =
          across * glm::dot(s.normal, to_viewer) - to_viewer * glm::dot(s.normal, across);
      const float length = glm::length(along);
      if (!(length > 0)) return;
      lines.aim(s.position, along / length);
      const float known =
          first_on_way(first_step(s), farthest_, [&](float t) { return lines.ends_beyond(t); });
      if (known < farthest_) solids_.beyond.at(x, y) = known;
    };
    for (int x = 0; x < w; ++x) end(x, 0, {0, -1}), end(x, h - 1, {0, 1});
    for (int y = 0; y < h; ++y) end(0, y, {-1, 0}), end(w - 1, y, {1, 0});
  }

  Solids& solids_;
  const Geometry& frame_;
  const std::vector<OtherView>& views_;
  PixelFootprint footprint_;
  float farthest_ = 0;
};

}  // namespace

void carve(Solids& solids, const Geometry& frame, const std::vector<OtherView>& views) {
  if (!views.empty() && !solids.thickness.empty()) Carver(solids, frame, views).carve();
}

}  // namespace ssdo
