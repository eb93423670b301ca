// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>

#include "scene/geometry.h"
#include "scene/other_views/other_view.h"

namespace ssdo {

/// How samples of a view and of a frame fit where both cameras look: of the frame's surfaces that
/// face the view's camera and lie in its picture, and of the view's that lie in the frame's.
/// What one camera hides from the other counts as neither.
struct Agreement {
  struct Side {
    std::size_t shared = 0;         ///< both show a surface at this place
    std::size_t contradictory = 0;  ///< one looks through what the other shows

    std::size_t all() const { return shared + contradictory; }
  };
  std::array<Side, 6> sides;  ///< by the side of a cube that the surfaces face

  std::size_t shared() const;
  std::size_t all() const;

  /// The number of sides with enough samples, and the mean of their shares of shared samples, 0..1.
  /// Each side counts alike, since many scenes have the same ground.
  int known_sides() const;
  double share() const;
};

/// A view of --also as it fits the frame.
struct Registration {
  std::optional<OtherView> view;  ///< nothing: no unit and no axes of its P make it fit
  std::string warning;            ///< of a view that was changed, or is left out; else empty
};

/// Returns the view unchanged if it fits the frame, or if they share too little to tell. If not,
/// tries other units and axes and applies those that fit; see registration.cpp.
Registration register_view(OtherView view, const Geometry& frame);

}  // namespace ssdo
