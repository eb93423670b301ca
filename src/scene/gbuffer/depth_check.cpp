// SPDX-License-Identifier: Apache-2.0
//
// DepthModel holds a depth to P before the camera is known: any affine function of P whose gradient
// is a unit vector may be the depth along an axis, and the coordinates of P are such functions.
// Here the axis and the place of the camera are known.
#include "scene/gbuffer/depth_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "scene/camera/projection_model.h"
#include "scene/gbuffer/background.h"
#include "scene/marked_pixels.h"

namespace ssdo {
namespace {

constexpr std::size_t kMostPixels = 20000, kFewestPixels = 16;

/// A depth is right if this share of the pixels agrees within the relative tolerance, as in
/// depth_model.cpp; averaged silhouettes disagree.
constexpr double kTolerance = 0.05, kLeastShare = 0.5;

/// A wrong depth is named where the quantity that is named matches in nearly all pixels.
constexpr double kExact = 1e-3, kNearlyAll = 0.9;

/// Up to this share, pixels with a P are as good as none.
constexpr double kNextToNone = 0.01;

bool shows_place(const glm::vec3& p) { return p != glm::vec3(0) && glm::length(p) < kEmptyDepth; }

struct Pixel {
  glm::dvec3 p;  ///< as stored
  double depth, rounding;
};

std::vector<Pixel> collect(const GBuffer& g) {
  std::vector<Pixel> pixels;
  for (const std::size_t i : every_marked(g.valid, count_marked(g.valid) / kMostPixels + 1)) {
    const glm::dvec3 p(g.position[i]), size = glm::abs(p);
    pixels.push_back({p, g.depth[i], 2 * g.position_step * std::max({size.x, size.y, size.z})});
  }
  return pixels;
}

using Measure = std::function<double(const glm::dvec3& p)>;

/// The share of the pixels whose depth is `measure` of P, plus `offset`, relative to the depth.
double share_of(const std::vector<Pixel>& pixels, const Measure& measure, double tolerance,
                double offset = 0) {
  const auto agreeing = std::count_if(pixels.begin(), pixels.end(), [&](const Pixel& pixel) {
    return std::abs(measure(pixel.p) + offset - pixel.depth) <=
           tolerance * pixel.depth + pixel.rounding;
  });
  return double(agreeing) / double(pixels.size());
}

/// The median by which the depth is larger than `measure` of P.
double offset_of(const std::vector<Pixel>& pixels, const Measure& measure) {
  std::vector<double> offsets;
  for (const Pixel& pixel : pixels) offsets.push_back(pixel.depth - measure(pixel.p));
  return quantile(offsets, 0.5);
}

}  // namespace

std::string what_depth_is_instead(const GBuffer& g, const Camera& camera) {
  const std::vector<Pixel> pixels = collect(g);
  if (pixels.size() < kFewestPixels) {
    const auto shown =
        std::count_if(g.position.pixels.begin(), g.position.pixels.end(), shows_place);
    return double(pixels.size()) < kNextToNone * double(shown) ? "it shows next to no surface" : "";
  }
  const Measure along_axis = [&](const glm::dvec3& p) { return -camera.to_camera(p).z; };
  const Measure along_ray = [&](const glm::dvec3& p) { return glm::distance(p, camera.origin); };
  if (camera.orthographic) {
    // Mirrored along the axis, an orthographic picture stays the same.
    const Measure mirrored = [&](const glm::dvec3& p) { return -along_axis(p); };
    for (const Measure& measure : {along_axis, mirrored})
      if (share_of(pixels, measure, kTolerance, offset_of(pixels, measure)) >= kLeastShare)
        return "";
  } else {
    for (const Measure& measure : {along_axis, along_ray})
      if (share_of(pixels, measure, kTolerance) >= kLeastShare) return "";
  }

  for (int axis = 0; axis < 3; ++axis) {
    const Measure coordinate = [=](const glm::dvec3& p) { return std::abs(p[axis]); };
    if (share_of(pixels, coordinate, kExact) >= kNearlyAll)
      return fmt::format("it is the {} of P", "xyz"[axis]);
  }
  const Measure from_origin = [](const glm::dvec3& p) { return glm::length(p); };
  if (share_of(pixels, from_origin, kExact) >= kNearlyAll)
    return "it is the distance from the origin of P";
  for (const Measure& measure : {along_axis, along_ray}) {
    const double offset = offset_of(pixels, measure);
    if (share_of(pixels, measure, kExact, offset) >= kNearlyAll)
      return fmt::format("it is the distance from the camera {} {:.3g}", offset < 0 ? '-' : '+',
                         std::abs(offset));
  }
  return "it is not the distance from the camera: remapped, or of another frame";
}

}  // namespace ssdo
