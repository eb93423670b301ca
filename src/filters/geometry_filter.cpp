// SPDX-License-Identifier: Apache-2.0
//
// The geometry-aware blur of screen-space directional occlusion (Ritschel et al. 2009, section 5):
// a window of the pattern's size, weighted by how far a neighbour's position lies from the pixel's
// tangent plane and by how far their normals differ.
//
//   out(p) = sum_q b(q) w(p, q) in(q) / sum_q b(q) w(p, q)
//   w = ramp(|n_p . (q - p)| / (t |q - p|)) * ramp((1 - n_p . n_q) / (1 - c))
//   ramp(x) = 1 up to 1/2, falling to 0 at 1
//
// The first argument is the sine of the angle by which q leaves the tangent plane, so that the
// weight knows no unit and no resolution. The flat part matters: where a surface bends gently, all
// members of the pattern have to weigh the same, or the pattern shows through.
//
// The window is T + 1 wide, with b = 1/2 at its ends: each of the T x T members of the pattern
// then has a total weight of exactly 1, which removes the pattern on a plane, and the window has a
// centre, which T alone has not.
#include "filters/geometry_filter.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kPlaneTolerance = 0.3f;  ///< t: the sine of 17 degrees
constexpr float kNormalCosine = 0.8f;    ///< c: normals 37 degrees apart share nothing

float ramp(float x) { return std::clamp(2 - 2 * x, 0.0f, 1.0f); }

/// One neighbour of the window and its weight.
struct Tap {
  std::size_t index;
  float weight;
};

/// The neighbours that lie on the surface of pixel (x, y), itself among them.
class SurfaceWindow {
 public:
  SurfaceWindow(const Geometry& geometry, int pattern_size)
      : geometry_(geometry), half_(pattern_size / 2) {}

  template <class Visit>
  void visit(int x, int y, const Visit& visit_tap) const {
    const glm::vec4 p = geometry_.surfel(x, y).position, n = geometry_.surfel(x, y).normal;
    for (int dy = -half_; dy <= half_; ++dy) {
      for (int dx = -half_; dx <= half_; ++dx) {
        const int qx = x + dx, qy = y + dy;
        if (qx < 0 || qy < 0 || qx >= geometry_.surfel.width || qy >= geometry_.surfel.height)
          continue;
        const std::size_t i = geometry_.surfel.index(qx, qy);
        if (!geometry_.is_surface(i)) continue;
        const float border =
            (std::abs(dx) == half_ ? 0.5f : 1.0f) * (std::abs(dy) == half_ ? 0.5f : 1.0f);
        const float weight =
            border * similarity(p, n, geometry_.surfel[i].position, geometry_.surfel[i].normal);
        if (weight > 0) visit_tap(Tap{i, weight});
      }
    }
  }

 private:
  static float similarity(const glm::vec4& p, const glm::vec4& n, const glm::vec4& q,
                          const glm::vec4& m) {
    const glm::vec3 step(q - p), normal(n);
    const float distance = glm::length(step);
    const float off_plane = std::max(0.0f, std::abs(glm::dot(step, normal)) - n.w - m.w);
    const float plane = distance > 0 ? off_plane / (kPlaneTolerance * distance) : 0.0f;
    const float turn = (1 - glm::dot(normal, glm::vec3(m))) / (1 - kNormalCosine);
    return ramp(plane) * ramp(turn);
  }

  const Geometry& geometry_;
  int half_;
};

}  // namespace

Products filter_geometry(const Products& noisy, const Geometry& geometry, int pattern_size) {
  Products out = noisy;
  const SurfaceWindow window(geometry, pattern_size);
  for_each_tile(geometry.surfel.width, geometry.surfel.height, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = geometry.surfel.index(x, y);
        if (!geometry.is_surface(i)) continue;
        float weights = 0, ao = 0;
        glm::vec3 direct(0), bounce(0);
        window.visit(x, y, [&](const Tap& tap) {
          weights += tap.weight;
          if (!noisy.ao.empty()) ao += tap.weight * noisy.ao[tap.index];
          if (!noisy.direct.empty()) direct += tap.weight * noisy.direct[tap.index];
          if (!noisy.bounce.empty()) bounce += tap.weight * noisy.bounce[tap.index];
        });
        if (!(weights > 0)) continue;
        const float scale = 1 / weights;
        if (!out.ao.empty()) out.ao[i] = std::clamp(ao * scale, 0.0f, 1.0f);
        if (!out.direct.empty()) out.direct[i] = direct * scale;
        if (!out.bounce.empty()) out.bounce[i] = bounce * scale;
      }
    }
  });
  return out;
}

}  // namespace ssdo
