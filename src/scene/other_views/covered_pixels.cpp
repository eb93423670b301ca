// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/covered_pixels.h"

#include <glm/geometric.hpp>

#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

/// Coverage from which on a pixel is the object's alone, whatever it lies on: sums of ranks are
/// rounded.
constexpr float kAll = 0.99f;

class CoveredPixels {
 public:
  CoveredPixels(const Surfaces& surfels, const Camera& camera, const Plane<float>& coverage)
      : surfels_(surfels), coverage_(coverage), footprint_(camera) {}

  bool operator()(int x, int y) const {
    const float covered = coverage_(x, y);
    if (!(covered > 0) || covered >= kAll) return covered >= kAll;
    const Surfel& s = surfels_(x, y);
    if (!s.is_surface()) return covered >= 0.5f;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const auto q = surface_at(surfels_, x + dx, y + dy);
        if (!q || coverage_(x + dx, y + dy) > 0) continue;
        const bool is_alike = glm::dot(s.normal, q->normal) > kOneNormal;
        if (is_alike &&
            on_one_surface({s.position, s.normal}, {q->position, q->normal}, footprint_))
          return false;
      }
    }
    return true;
  }

 private:
  const Surfaces& surfels_;
  const Plane<float>& coverage_;
  PixelFootprint footprint_;
};

}  // namespace

Plane<unsigned char> covered_pixels(const Surfaces& surfels, const Camera& camera,
                                    const Plane<float>& coverage) {
  Plane<unsigned char> covered(coverage.width, coverage.height);
  const CoveredPixels is_covered(surfels, camera, coverage);
  for_each_row(covered.height, [&](int y) {
    for (int x = 0; x < covered.width; ++x) covered(x, y) = is_covered(x, y);
  });
  return covered;
}

}  // namespace ssdo
