// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "io/images/image.h"

namespace ssdo {

/// What the tool asks of the module that image files go through. It is a file of its own, loaded
/// when the first image is read or written: Debian's OpenImageIO brings 250 libraries, which take
/// longer to load than a small frame takes to relight, and EXR to EXR needs none of them.
struct ImageCodec {
  /// read_image() of a file that exists; with `take` read_image_rows(), which returns no pixels.
  Image (*read)(const std::filesystem::path& path, const TakeRows* take);
  /// encode_image().
  std::vector<unsigned char> (*encode)(const std::filesystem::path& name, const ImageSpec& spec,
                                       std::span<const float> values);
};

/// The module's file, and the function in it that returns its codec; `threads` are those that it
/// may use, or 0 to let it choose, `memory` the bytes.
inline constexpr const char* kCodecFile = "ssdo_images.so";
inline constexpr const char* kCodecFunction = "ssdo_image_codec";
using GetImageCodec = const ImageCodec*(int threads, double memory);

}  // namespace ssdo
