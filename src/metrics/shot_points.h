// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "metrics/flicker.h"
#include "scene/geometry.h"

namespace ssdo {

/// The surfaces of the frames of a shot, of which it keeps those of the latest.
class ShotPoints {
 public:
  /// `pattern` names G-buffers whose layers and camera are found as those of a frame; `camera` is
  /// the value of --camera, or empty.
  ShotPoints(std::string pattern, std::string camera)
      : pattern_(std::move(pattern)), camera_(std::move(camera)) {}

  /// What the frame `number` and the one that was asked for before both show, of the pixels for
  /// which `counts(x, y)` holds, in display coordinates; nothing for the first. A motion layer
  /// tells what moves where it leads to that frame. `display` is the display window of what is
  /// measured; adds to `notes`. After an error the next frame has none before it. Errors: those of
  /// reading a view; ExitCode::layer where P does not tell the world space, and where the G-buffer
  /// has another display window.
  std::optional<SharedPoints> next(int number, const Window& display,
                                   const std::function<bool(int x, int y)>& counts,
                                   std::vector<std::string>& notes);

  /// Makes the next frame one without a frame before it.
  void forget() { before_.reset(); }

 private:
  struct Seen {
    int number;
    Geometry geometry;
  };

  std::string pattern_, camera_;
  std::optional<Seen> before_;
};

}  // namespace ssdo
