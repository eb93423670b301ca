// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "io/pictures/picture_layers.h"

namespace ssdo {

/// A layer of picture A and what it is compared with in picture B.
struct LayerPair {
  PictureLayer a, b;

  /// "ao", or "direct - ViewLayer.DiffDir" of layers with two names.
  std::string name() const;
};

/// The layers that are named, or all that both pictures have, in the components that both have.
/// Errors: ExitCode::layer for a name that is not there, and where there is nothing in common.
std::vector<LayerPair> pair_layers(const LayeredPicture& a, const LayeredPicture& b,
                                   const std::string& layer_a, const std::string& layer_b);

/// The layer of that name, or all of one picture, each paired with itself.
std::vector<LayerPair> layers_alone(const LayeredPicture& picture, const std::string& layer);

/// The pairs by what their channels are, where both layers have the same: colours, or a coordinate;
/// an alpha, a depth and all else alone.
std::vector<LayerPair> split_by_kind(const std::vector<LayerPair>& pairs);

/// The channels that no pair compares, of the picture whose layer of a pair is `side`.
std::vector<std::string> unpaired(const LayeredPicture& picture,
                                  const std::vector<LayerPair>& pairs,
                                  PictureLayer LayerPair::*side);

/// Whether the picture has colours, vectors or values that no pair compares. Not an alpha alone,
/// which one kind of picture has and another has not.
bool lacks_counterpart(const LayeredPicture& picture, const std::vector<LayerPair>& pairs,
                       PictureLayer LayerPair::*side);

}  // namespace ssdo
