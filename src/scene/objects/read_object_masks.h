// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/objects/object_masks.h"
#include "scene/objects/object_options.h"
#include "scene/objects/selected_coverage.h"

namespace ssdo {

/// Opens the files of a selection, or of all of these, that are not among `files`. Errors: those of
/// ExrReader.
void open_mattes(const Selection& selection, std::deque<ExrReader>& files, bool allow_partial);
void open_mattes(const ObjectOptions& options, std::deque<ExrReader>& files, bool allow_partial);

/// The masks of these options. Errors: those of selected_coverage().
ObjectMasks read_object_masks(const ObjectOptions& options, const SelectionFiles& in,
                              const Window& window, const PixelGrid& grid);

}  // namespace ssdo
