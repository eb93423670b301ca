// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/exr/deep_reader.h"
#include "scene/geometry.h"
#include "scene/solids/solids.h"

namespace ssdo {

constexpr std::size_t kMostBehind = kMostLayers - 1;

/// What deep images show behind the surfaces of a frame. Lengths are in scene units along the ray
/// of the pixel, as those of a Solid.
struct MeasuredSolids {
  /// At most one in each pixel.
  struct Layer {
    Plane<float> distance;   ///< from the surface that the pixel shows; infinite: none
    Plane<float> thickness;  ///< infinite: not known
  };

  Plane<float> seen_thickness;  ///< of what the pixels show; infinite: not known
  std::vector<Layer> behind;    ///< near to far, kMostBehind at most
};

/// Least cosine between a normal and the view ray with which a gap along the ray is turned into one
/// across the surface: a smooth normal may lean away from the viewer.
constexpr float kLeastCosine = 0.1f;

/// How to read the depths of deep images.
struct DeepDepths {
  std::optional<DepthKind> kind;  ///< planar or ray; the one that fits the frame where not given
  float far = 0;                  ///< from this depth on samples show nothing
};

/// Finds the solids of deep images behind what a frame shows. Samples on the surface that a pixel
/// shows say how thick it is; those in front of it contradict the frame and are left out. The
/// images may be elements of one scene, in any order. Warnings go to `warnings`.
/// Errors: ExitCode::layer for an image of another display window, and where most pixels
/// contradict the frame.
MeasuredSolids measure_solids(const Geometry& geometry, const std::vector<DeepImage>& images,
                              const DeepDepths& depths, std::vector<std::string>& warnings);

}  // namespace ssdo
