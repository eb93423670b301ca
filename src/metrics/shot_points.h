// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "metrics/flicker.h"
#include "scene/geometry.h"
#include "scene/view.h"

namespace ssdo {

/// Reads what points are found with: positions, normals and motion of a frame. Errors: those of
/// read_view().
View read_points(const FrameFiles& files, const InputOptions& input, const CameraOptions& camera);

/// The surfaces of the frames of a shot, of which it keeps those of the latest.
class ShotPoints {
 public:
  /// The points that `view`, of frame `number`, and the view of the call before both show, at
  /// pixels for which `counts(x, y)` holds, in display coordinates; nothing for the first call. A
  /// motion layer is used only if it leads to the frame of that earlier view. `display` is the
  /// display window of what is measured; adds to `notes`. After an error the next call has no
  /// earlier view.
  /// Errors: ExitCode::layer where P does not tell the world space, and where `view` has another
  /// display window.
  std::optional<SharedPoints> next(int number, View view, const Window& display,
                                   const std::function<bool(int x, int y)>& counts,
                                   std::vector<std::string>& notes);

  /// The surfaces of the frame of the last call of next(), which threw nothing.
  const Geometry& latest() const { return before_->geometry; }

 private:
  struct Seen {
    int number;
    Geometry geometry;
  };

  std::optional<Seen> before_;
};

}  // namespace ssdo
