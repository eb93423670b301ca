// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "math/pixel_grid.h"
#include "math/plane.h"
#include "scene/objects/selection.h"

namespace ssdo {

/// Where selections are looked up.
struct SelectionFiles {
  const std::deque<ExrReader>&
      files;         ///< the frame, then others; those of the terms are among them
  std::string view;  ///< of a stereo file; empty: the only one
  /// Gets a line for each name that no manifest knows and no pixel has; null: not wanted.
  std::vector<std::string>* warnings = nullptr;
};

/// How much of each pixel of `window`, a part of `grid` of the frame, a selection covers, 0..1.
/// Cryptomattes: all ranks together, of every level that has the name; those of the frame before
/// those of its other files. Mattes and ids: as their layer says. Outside of a layer: 0.
///
/// Terms are taken from left to right. The ids of neighbouring terms that are Cryptomattes are
/// joined as sets; else coverage is added up to 1, or taken away down to 0.
///
/// Errors: ExitCode::layer for a name, layer or file that is not there, with the nearest ones, and
/// for a layer of another display window; those of find_cryptomattes().
Plane<float> selected_coverage(const Selection& selection, const SelectionFiles& in,
                               const Window& window, const PixelGrid& grid);

/// An object, material, asset or id of a frame.
struct ObjectShare {
  std::string layer, name;
  double share;  ///< of the pixels of the display window
};

/// What can be selected by name or id in a file: those that it shows, the largest first within a
/// layer. A Cryptomatte that cannot be read gives a line of `warnings`.
std::vector<ObjectShare> objects_of(const ExrReader& file, const std::string& view,
                                    std::vector<std::string>& warnings);

}  // namespace ssdo
