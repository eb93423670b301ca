// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "math/plane.h"
#include "metrics/compare_options.h"
#include "metrics/difference.h"
#include "metrics/picture_pairs.h"

namespace ssdo {

/// Pixels that count, over a window of their own.
class PictureMask {
 public:
  /// The mask in FILE or FILE:LAYER; an empty text holds every pixel. Errors: ExitCode::input,
  /// layer.
  explicit PictureMask(const std::string& text);

  /// Whether the mask is not 0 there, in the coordinates of the windows.
  bool holds(int x, int y) const;

 private:
  Window window_;
  std::vector<Plane<float>> planes_;
};

/// A pair of layers with its figures.
struct Compared {
  LayerPair pair;
  Channels a, b;  ///< empty unless they were to be kept
  ChannelsDifference difference;
};

/// All that is told of two pictures.
struct Comparison {
  std::vector<Compared> layers;
  std::vector<std::string> only_in_a, only_in_b;  ///< channels without a counterpart
  bool lacks_layers = false;                      ///< which fails the gate
};

/// Compares the pictures that `options` names, and writes their difference where it is asked for.
/// Errors: see compare().
Comparison compare_pictures(const CompareOptions& options, const PictureMask& mask,
                            bool keeps_channels = false);

/// Whether the comparison passes the gate.
bool passes(const CompareOptions& options, const Comparison& all);

/// Refuses a difference that cannot be written, or that would replace a picture.
void check_diff(const CompareOptions& options);

}  // namespace ssdo
