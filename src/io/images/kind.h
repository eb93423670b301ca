// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace ssdo {

/// Whether the ending of `path` is an image kind that write_image() can make: .png .jpg .jpeg .tif
/// .tiff, in any case.
bool is_display_image(const std::filesystem::path& path);

/// Whether that image kind can hold an alpha: all but JPEG.
bool keeps_alpha(const std::filesystem::path& path);

/// Whether the ending of `path` is .exr, in any case.
bool has_exr_ending(const std::filesystem::path& path);

}  // namespace ssdo
