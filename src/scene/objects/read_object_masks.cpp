// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/read_object_masks.h"

#include <algorithm>

namespace ssdo {

ObjectMasks read_object_masks(const ObjectOptions& options, const SelectionFiles& in,
                              const Window& window, const PixelGrid& grid) {
  const auto read = [&](const Selection& selection) {
    return selection.empty() ? Plane<float>() : selected_coverage(selection, in, window, grid);
  };
  ObjectMasks masks{read(options.only), read(options.holdout)};
  for (float& value : masks.kept.pixels) value = 1 - value;
  const Plane<float> more = read(options.no_receive);
  if (masks.kept.empty()) masks.kept = more;
  for (std::size_t i = 0; i < more.size(); ++i) masks.kept[i] = std::max(masks.kept[i], more[i]);
  return masks;
}

}  // namespace ssdo
