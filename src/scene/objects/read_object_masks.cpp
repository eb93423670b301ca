// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/read_object_masks.h"

#include <algorithm>

namespace ssdo {

void open_mattes(const Selection& selection, std::deque<ExrReader>& files, bool allow_partial) {
  for (const SelectionTerm& term : selection.terms) {
    const auto is_it = [&](const ExrReader& file) { return file.path() == term.file; };
    if (!term.file.empty() && std::ranges::none_of(files, is_it))
      files.emplace_back(term.file, allow_partial ? Salvage::done : Salvage::offered);
  }
}

void open_mattes(const ObjectOptions& options, std::deque<ExrReader>& files, bool allow_partial) {
  for (const Selection* selection : options.all()) open_mattes(*selection, files, allow_partial);
}

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
