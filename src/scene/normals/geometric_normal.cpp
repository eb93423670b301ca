// SPDX-License-Identifier: Apache-2.0
//
// Rows of normals are compiled once for every instruction set.
#include "scene/normals/geometric_normal.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "scene/normals/normals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "scene/normals/geometric_normal.cpp"
#include <hwy/foreach_target.h>

#include "scene/surfaces-inl.h"

#ifndef SSDO_GEOMETRIC_NORMAL_LIMITS
#define SSDO_GEOMETRIC_NORMAL_LIMITS
namespace ssdo {
namespace {

/// The surface at a pixel is smooth where its position and those on both sides are about on a line.
constexpr float kMostBend = 0.05f;      ///< sine between the halves
constexpr float kMostUneven = 1.3f;     ///< longer to shorter half
constexpr float kMostRounding = 0.03f;  ///< of the step

/// A normal that is nearer to that of the pixel than this cosine is the same.
constexpr float kSameCosine = 0.9994f;

/// A surface so steep may be the average of what is before an edge and what is behind it.
constexpr float kSteep = 0.05f;

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// smooth_step() of pixels with a surface on both sides.
HWY_INLINE V3 step_across(const Surfels& before, const Surfels& here, const Surfels& after) {
  const V3 first = here.position - before.position, second = after.position - here.position,
           step = first + second, bend = cross(first, second);
  const V first2 = dot(first, first), second2 = dot(second, second);
  const M even =
      hn::Max(first2, second2) <= set(kMostUneven * kMostUneven) * hn::Min(first2, second2);
  const M straight = hn::And(dot(first, second) > set(0),
                             dot(bend, bend) <= set(kMostBend * kMostBend) * first2 * second2);
  const M known =
      here.rounding * here.rounding <= set(kMostRounding * kMostRounding) * dot(step, step);
  return if_then_else_zero(hn::And(hn::And(even, straight), known), step);
}

void normals_of_row(const Surfaces& surfels, int y, bool orthographic,
                    std::span<glm::vec3> normals) {
  for (int x = 0; x < surfels.width; x += kLanes) {
    const Surfels here = surfels_at(surfels, x, y), left = surfels_at(surfels, x - 1, y),
                  right = surfels_at(surfels, x + 1, y), above = surfels_at(surfels, x, y - 1),
                  below = surfels_at(surfels, x, y + 1);
    const V3 n = cross(step_across(above, here, below), step_across(left, here, right)),
             view = orthographic ? set(glm::vec3(0, 0, 1)) : -normalise(here.position);
    const V length = hn::Sqrt(dot(n, n)), zero = set(0);
    const V3 normal = n / hn::IfThenElse(dot(n, view) < zero, hn::Neg(length), length);
    const M kept = hn::And(length > zero, hn::And(dot(normal, view) >= set(kSteep),
                                                  dot(normal, here.normal) <= set(kSameCosine)));
    const int count = std::min(int(kLanes), surfels.width - x);
    store_first(count, if_then_else(kept, normal, here.normal), &normals[std::size_t(x)]);
    // At the border and beside background some pixels have other neighbours.
    const M inside = hn::And(hn::And(left.surface, right.surface),
                             hn::And(above.surface, below.surface)),
            outside = hn::AndNot(inside, here.surface);
    if (!any(outside)) continue;
    alignas(64) float is_outside[kLanes];
    store(hn::IfThenElseZero(outside, set(1)), is_outside);
    for (int k = 0; k < count; ++k) {
      if (is_outside[k] == 0) continue;
      const glm::vec3 to_viewer = direction_to_viewer(surfels(x + k, y).position, orthographic);
      normals[std::size_t(x + k)] = geometric_normal(surfels, x + k, y, to_viewer);
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {
namespace {

HWY_EXPORT(normals_of_row);

/// The step from the pixel before to the one after along one axis, where these two and the pixel
/// lie about on a line, as on a smooth surface. Zero elsewhere.
glm::vec3 smooth_step(const Surfaces& surfels, int x, int y, int dx, int dy) {
  // At the border and beside background, from the two on the other side.
  const Surfel& here = surfels(x, y);
  std::optional<Surfel> before = surface_at(surfels, x - dx, y - dy), middle = here,
                        after = surface_at(surfels, x + dx, y + dy);
  if (!before) before = middle, middle = after, after = surface_at(surfels, x + 2 * dx, y + 2 * dy);
  if (!after) after = middle, middle = before, before = surface_at(surfels, x - 2 * dx, y - 2 * dy);
  if (!before || !middle || !after) return glm::vec3(0);
  const glm::vec3 first = middle->position - before->position,
                  second = after->position - middle->position, step = first + second,
                  bend = glm::cross(first, second);
  const float first2 = glm::dot(first, first), second2 = glm::dot(second, second);
  const bool even =
      std::max(first2, second2) <= kMostUneven * kMostUneven * std::min(first2, second2);
  const bool straight = glm::dot(first, second) > 0 &&
                        glm::dot(bend, bend) <= kMostBend * kMostBend * first2 * second2;
  const bool known =
      here.rounding * here.rounding <= kMostRounding * kMostRounding * glm::dot(step, step);
  return even && straight && known ? step : glm::vec3(0);
}

}  // namespace

glm::vec3 geometric_normal(const Surfaces& surfels, int x, int y, const glm::vec3& view) {
  const glm::vec3 shading = surfels(x, y).normal;
  const glm::vec3 n =
      glm::cross(smooth_step(surfels, x, y, 0, 1), smooth_step(surfels, x, y, 1, 0));
  const float length = glm::length(n);
  if (!(length > 0)) return shading;
  const glm::vec3 normal = n / (glm::dot(n, view) < 0 ? -length : length);
  const bool steep = !(glm::dot(normal, view) >= kSteep);  // or not a number
  return steep || glm::dot(normal, shading) > kSameCosine ? shading : normal;
}

void find_geometric_normals(const Surfaces& surfels, int y, bool orthographic,
                            std::span<glm::vec3> normals) {
  HWY_DYNAMIC_DISPATCH(normals_of_row)(surfels, y, orthographic, normals);
}

}  // namespace ssdo
#endif
