// SPDX-License-Identifier: Apache-2.0
//
// What the learned prior is told about a pixel, in the order of data/prior/features.py: the pixel
// itself, means of the frame, and means of strips along its borders. All of it is without units,
// and changes continuously with the camera. Where a strip shows few surfaces, its means lean to
// those of the frame.
//
// Means of the surroundings of the pixel, at three scales, are no help beside these: trained with
// them or without, the prior errs by the same on scenes that it has not seen.
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "math/plane.h"
#include "prior/prior_grid.h"
#include "scene/geometry.h"

namespace ssdo {

/// The matrix that turns directions from camera space to the axes of the inputs; its rows are
/// right, ahead and up. `up` unit, in camera space: then the axes stand upright and face where the
/// camera looks, continuously also where it looks straight down. Without it, they are the camera's.
glm::mat3 prior_axes(const std::optional<glm::vec3>& up);

/// What the prior is told of a frame as a whole. For a frame that is computed in bands, it comes
/// from the overview.
struct PriorContext {
  /// The values whose means are taken; names with 2 are squares, for deviations.
  enum Value {
    kNormal = 0,
    kLevel = 3,  ///< share of the normal that is vertical
    kLogDepth,
    kLogDepth2,
    kAo,
    kGuessed,
    kOpen,  ///< how much more is open if surfaces end at the border
    kBent,
    kAo2 = kBent + 3,
    kGuessed2,
    kValues
  };
  using Values = std::array<float, kValues>;

  /// Of a part of the frame: the share that shows surfaces, and means over these.
  struct Means {
    float covered = 0;
    Values of = {};
  };

  float mean_log_depth = 0;  ///< see PriorInputs::find_log_depth()
  Means frame;
  std::array<Means, 4> sides;  ///< along top, bottom, left and right
};

class PriorInputs {
 public:
  /// Inputs of a pixel, and those that all pixels have in common, which follow them: of the frame,
  /// and of each side.
  static constexpr std::size_t kOwn = 19, kShared = 16 + 4 * 6;

  /// `grid` with the means of what was found; `radius` in scene units, or infinity; `up` as
  /// prior_axes() has it. `of_frame`: the context of the frame, if the geometry is a band; null:
  /// found from the squares.
  PriorInputs(const PriorGrid& grid, const Geometry& geometry, const std::optional<glm::vec3>& up,
              float radius, const PriorContext* of_frame = nullptr);

  const PriorContext& context() const { return context_; }
  std::span<const float> shared() const { return shared_; }

  /// Writes the own inputs of a row of squares: kOwn rows, `stride` floats apart.
  void write(int y, std::size_t stride, float* rows) const;

 private:
  using Value = PriorContext::Value;
  using Values = PriorContext::Values;

  void find_log_depth(bool is_known);
  void find_means(double aspect);
  void share();
  Values values_of(int x, int y) const;

  const PriorGrid& grid_;
  glm::mat3 axes_;
  bool orthographic_;
  float lens_;  ///< geometric mean of half the width and half the height: slopes, or scene units
  float log_lens_, log_aspect_, pitch_, radius_;
  Plane<float> log_depth_;
  PriorContext context_;
  std::vector<float> shared_;
};

}  // namespace ssdo
