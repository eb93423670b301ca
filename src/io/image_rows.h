// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "io/image_file.h"

namespace ssdo {

/// Takes the next rows of an image, from its row `first` on. `image` has its size and what its file
/// says of it, but no pixels.
using TakeRows = std::function<void(const Image& image, int first, const Plane<glm::vec3>& rows)>;

/// Reads the colours of an image as read_image() does, some rows at a time; all at once where its
/// file stores them in another order. Errors: those of read_image() and of `take`.
void read_image_rows(const std::filesystem::path& path, const TakeRows& take);

}  // namespace ssdo
