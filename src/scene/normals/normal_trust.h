// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "math/plane.h"
#include "scene/surfaces.h"

namespace ssdo {

struct NormalSpace;

/// How far the stored normals are used: 1 as they are, 0 rebuilt from P, a blend between; at the
/// centres of square cells, about 24 over the width of the frame.
struct NormalTrust {
  Plane<float> cells = {};   ///< empty: all normals are used as they are
  Plane<float> smooth = {};  ///< pixels of each cell that tell: where P is smooth
  int cell_size = 1;         ///< in pixels

  /// At a pixel, between the four cells around it.
  float at(int x, int y) const;

  /// Least, mean and largest trust over the cells that have pixels to measure; the mean is weighted
  /// by the number of these pixels.
  float least() const;
  float mean() const;
  float most() const;
};

/// Decides how far normals that disagree with the gradient of P in part of the frame are used.
/// Cells in which they agree on average keep them, whatever the rest of the frame shows: so bumps
/// of any height stay, and one object cannot take the normal map of another away. Normals that
/// disagree are kept too (leaves that are lit as a crown), unless most cells disagree, or N shows
/// edges across surfaces that P shows to be smooth: then N is that of another frame, and all of it
/// is rebuilt. All steps between are continuous in what the frame shows.
NormalTrust find_normal_trust(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                              const NormalSpace& space, bool orthographic);

}  // namespace ssdo
