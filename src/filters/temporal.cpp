// SPDX-License-Identifier: Apache-2.0
//
// Reprojection of what earlier frames have found (Nehab et al., "Accelerating Real-Time Shading
// with Reverse Reprojection Caching", 2007), the temporal filter of ground-truth ambient occlusion.
//
//   mean(p) = (n h + now(p)) / (n + 1),  n = min(frames(p'), 15)
//
// h is what the frame before has at p', where its camera saw the point that p shows: the bilinear
// average of the pixels around p' that show the same surface,
//
//   |N_p . (q - p)| and |N_q . (q - p)| <= half the width of a pixel at p + the rounding of P,
//   N_p . N_q >= 0.9,
//
// their weights scaled to a sum of 1. Where they have less than a tenth of the weight, p was
// occluded, outside the picture, or has moved: the mean restarts with n = 0. The limit of the two
// distances to tangent planes does not grow with the distance between q and p, so that a surface
// which occluded p in the frame before is recognised even at grazing angles.
//
// A moving object keeps its history where a motion layer gives p'. Its P has changed by an unknown
// vector d. The picture shows only the component of d across the view: m, the distance between the
// p' of the layer and the p' of the cameras, in scene units at p. The limit of both distances to
// tangent planes grows by 2 m, which allows a d up to 60 degrees out of the picture's plane; an
// object that moves straight at the viewer restarts. Where layer and cameras agree, m is 0 and the
// test is unchanged, so that a static background uncovered by a moving object is held to its own P.
// Normals are not turned, so that an object may rotate by 26 degrees per frame.
//
// What differs from games: the mean counts all frames up to the 16th and becomes exponential only
// then, so that a static camera converges; P is known, so that static surfaces need no motion
// vectors; colours are not clamped to those of the neighbours, which would take noise for light.
//
// Known faults: light that changes on a static surface, such as a moving shadow, lags by 16 frames;
// the bent normal of a rotating object lags too.
#include "filters/temporal.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <type_traits>

#include "filters/reprojection.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kMostFrames = 15;  ///< of history; with the present frame the mean counts 16

bool same_products(const Products& a, const Products& b) {
  bool same =
      std::ranges::equal(a.lights, b.lights, {}, &LightProducts::name, &LightProducts::name);
  if (!same) return false;
  for_each_plane([&](const Product&, const auto& one,
                     const auto& other) { same = same && one.empty() == other.empty(); },
                 a, b);
  return same;
}

template <class T>
T average(const Plane<T>& plane, const PixelsBefore& at) {
  const T first = plane[at.pixel[0]];
  T step(0);  // differences, so that what is constant stays as it is
  for (int k = 1; k < at.count; ++k) step += at.weight[k] * (plane[at.pixel[k]] - first);
  return first + step;
}

/// value = (n h + value) / (n + 1), as a step for the same reason.
template <class T>
void mix(T& value, const T& history, float frames) {
  value += (frames / (frames + 1)) * (history - value);
}

/// Adds to pixel `i` of each product what `old` has at `at`; `turn` leads from the camera space of
/// `old` to the present one.
void mix_products(Products& mean, std::size_t i, const Products& old, const PixelsBefore& at,
                  const glm::mat3& turn, float frames) {
  for_each_plane(
      [&](const Product& product, auto& values, const auto& before) {
        if (values.empty()) return;
        auto history = average(before, at);
        if constexpr (std::is_same_v<decltype(history), glm::vec3>) {
          if (product.kind == ProductKind::direction) history = turn * history;
        }
        mix(values[i], history, frames);
      },
      mean, old);
}

/// A mean over frames is finished as one over neighbours is.
float finished(float value, Finish finish) {
  return finish == Finish::clamp ? std::clamp(value, 0.0f, 1.0f) : value;
}

glm::vec3 finished(const glm::vec3& value, Finish finish) {
  if (finish != Finish::normalise) return value;
  const float length = glm::length(value);
  return length > 0 ? value / length : glm::vec3(0);
}

}  // namespace

History accumulate(const History* before, const Geometry& geometry, const Products& now,
                   const Plane<glm::vec2>& motion) {
  History after;
  after.mean = now;
  after.frames = Plane<float>(geometry.surfaces.width, geometry.surfaces.height);
  for (std::size_t i = 0; i < after.frames.size(); ++i) after.frames[i] = geometry.is_surface(i);
  if (!before || !before->geometry.world_known || !geometry.world_known ||
      !same_products(before->mean, now)) {
    return after;
  }
  const Reprojection reprojection(before->geometry, geometry);
  const glm::mat3 turn = reprojection.to_present();
  for_each_row(geometry.surfaces.height, [&](int y) {
    for (int x = 0; x < geometry.surfaces.width; ++x) {
      const std::size_t i = geometry.surfaces.index(x, y);
      if (!geometry.is_surface(i)) continue;
      const glm::dvec2 from_motion =
          motion.empty() ? glm::dvec2(NAN) : centre_of(geometry, x, y) + glm::dvec2(motion[i]);
      const PixelsBefore at = reprojection.find(geometry.surfaces[i], from_motion);
      if (at.count == 0) continue;
      const float frames = std::min(average(before->frames, at), kMostFrames);
      mix_products(after.mean, i, before->mean, at, turn, frames);
      after.frames[i] = frames + 1;
    }
  });
  return after;
}

Products products_of(const History& history) {
  Products products = history.mean;
  for_each_plane(
      [](const Product& product, auto& plane) {
        for (auto& value : plane.pixels) value = finished(value, product.filtering.finish);
      },
      products);
  return products;
}

}  // namespace ssdo
