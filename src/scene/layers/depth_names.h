// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "scene/depth_model.h"
#include "scene/layers/layers.h"

namespace ssdo {

/// What a tool stores in depth layers of one name.
struct DepthName {
  std::string_view name;    ///< as normalise() leaves it; `*` stands for anything
  DepthKind kind;           ///< ray, or normalized: remapped by ends that the file does not tell
  std::string_view reason;  ///< in messages
};

/// The row for a layer of depths, by the name of the layer or of its channel; null for names that
/// say nothing.
const DepthName* find_depth_name(const Layer& layer);

}  // namespace ssdo
