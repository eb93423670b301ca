// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "math/half_color.h"
#include "scene/geometry.h"
#include "scene/other_views/other_surfaces.h"
#include "scene/other_views/other_view.h"

namespace ssdo {

/// What became of the pixels of another view that show a surface. Of a view of back faces only
/// `backs` counts.
struct MergeCounts {
  std::string file;
  bool has_albedo = false;
  std::size_t added = 0;          ///< the frame does not show what they show
  std::size_t seen = 0;           ///< the frame shows it as well
  std::size_t contradictory = 0;  ///< it would lie before what the frame shows: something moved
  bool is_other_eye = false;      ///< of its stereo pair
  std::size_t backs = 0;          ///< pixels of the frame whose thickness it shows

  /// Pixels that show what the frame should see too.
  std::size_t in_common() const { return seen + contradictory; }

  /// Whether too little of the other eye lies where the frame shows it: it shows another scene.
  bool is_of_another_scene() const;
};

/// Joins what other views show. The views' order does not matter. `albedo` is the frame's.
/// `counts` has a row for each view, in their order. Another eye that shows another scene is left
/// out.
OtherSurfaces merge_views(const std::vector<OtherView>& views, const Geometry& frame,
                          const Plane<HalfColor>& albedo, std::vector<MergeCounts>& counts);

}  // namespace ssdo
