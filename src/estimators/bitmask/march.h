// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/bitmask/march_scene.h"
#include "estimators/bitmask/slice_pattern.h"
#include "math/octahedral_map.h"
#include "scene/light/light.h"
#include "simd/interleaved.h"

namespace ssdo {

/// What all marches share.
struct March {
  const MarchScene& scene;
  const SlicePattern& pattern;
  float radius;  ///< scene units, or infinity
  bool extend;   ///< surfaces go on beyond the frame
};

/// How open each pixel is, and to which light.
struct VisibilityJob {
  March march;
  /// Bands of spherical harmonics that light is gathered in, up to 4; 0: no direction matters.
  int order = 0;
  /// Weights of the basis polynomials, (order + 1)^2 for red, then green, then blue.
  const float* light = nullptr;               ///< null: it comes from everywhere alike
  const OctahedralMap* irradiance = nullptr;  ///< over pi, by normal, where nothing is in the way
  float through_beyond = 0;  ///< share of it that comes through what may go on beyond the frame

  InterleavedPlane* ao = nullptr;
  InterleavedVectors* bent = nullptr;    ///< unit; null: not wanted
  InterleavedVectors* direct = nullptr;  ///< null: not wanted
  InterleavedPlane* difference =
      nullptr;  ///< standard error of its luminance, signed; null: not wanted
};

/// What each pixel sends to others, and its unseen side.
struct SenderJob {
  const MarchScene& scene;
  const InterleavedPlane* ao;
  const InterleavedVectors *albedo, *direct;
  const InterleavedVectors* bounce;  ///< that has arrived so far; null: none
  const Light& light;
  InterleavedVectors* sent;       ///< may be the albedo
  InterleavedVectors* sent_back;  ///< null: the same
};

/// What each pixel receives from the first surface in every direction: the mean radiance of what
/// hides the environment, times how much of it is hidden.
struct BounceJob {
  March march;
  const InterleavedPlane* ao;
  const InterleavedVectors* sent;                      ///< radiance of layer 0
  const InterleavedVectors* sent_back;                 ///< of its other side; null: the same
  const std::vector<InterleavedVectors>* sent_behind;  ///< of layers 1, 2, ...
  const BorderValues* sent_border;                     ///< of what goes on beyond the frame, three

  // What the pixels that march have met.
  InterleavedVectors* gathered;  ///< sum of radiance
  InterleavedPlane* weights;     ///< sum of the weights
  InterleavedPlane*
      difference;  ///< error of the luminance of the mean, times them; null: not wanted

  InterleavedVectors* bounce;
  InterleavedPlane* error;  ///< standard error of its luminance, signed; null: not wanted
};

/// The direct light of a sun, where it is seen.
struct SunJob {
  March march;
  /// For each member of the pattern a unit direction to a point of the sun, and where on the way
  /// there the march looks, near to far.
  std::array<glm::vec3, Interleaving::kPeriod * Interleaving::kPeriod> directions;
  std::array<std::vector<float>, Interleaving::kPeriod * Interleaving::kPeriod> distances_px;
  const Sun* sun;
  float past_beyond;           ///< share of it that passes what may stand beyond the frame
  InterleavedVectors* direct;  ///< added to
};

/// All work on a part of the raster, and may write to pixels beside it in the same rows.
void march_visibility(const VisibilityJob& job, const Window& part);
void march_bounce(const BounceJob& job, const Window& part);
/// After march_bounce of the part and, where the pattern has a spacing, of the pixels around it.
void spread_bounce(const BounceJob& job, const Window& part);
void march_sun(const SunJob& job, const Window& part);
void find_senders(const SenderJob& job, const Window& part);

}  // namespace ssdo
