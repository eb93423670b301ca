// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "io/images/kind.h"
#include "io/safe_file.h"
#include "math/plane.h"

namespace ssdo {

/// An image without a colour transform, turned as its file says.
struct Image {
  Plane<glm::vec3> color;   ///< the first three channels, or one as grey
  Plane<float> alpha;       ///< empty where there is none
  bool integers = false;    ///< stored as integers, which become 0..1
  std::string color_space;  ///< that the file names, as OpenImageIO calls it; empty: none
};

/// Loads the module that the functions below need, before work that would be lost without it.
/// Errors: ExitCode::failed where it is missing.
void load_image_codec();

/// Reads a flat image: PNG, JPEG, TIFF or Radiance HDR, whatever the file is called.
/// Errors: ExitCode::input, also for a file that is cut short and that the library would fill up.
Image read_image(const std::filesystem::path& path);

/// What a display image is stored as.
struct ImageSpec {
  int width = 0, height = 0;
  int channels = 3;        ///< 1 grey, 3 RGB, 4 RGB and unassociated alpha
  int bits = 8;            ///< 8 or 16 per channel; JPEG is always 8
  float pixel_aspect = 1;  ///< width of a pixel over its height
};

/// The bytes of an image file of the kind that the ending of `name` says, from interleaved values
/// in 0..1 (others are clamped, NaN becomes 0).
/// Errors: ExitCode::output, naming `name`.
std::vector<unsigned char> encode_image(const std::filesystem::path& name, const ImageSpec& spec,
                                        std::span<const float> values);

/// Writes interleaved values in 0..1, as encode_image() does, to the temporary of `file`; the
/// caller commits it. The kind follows the ending of the target. JPEG drops a fourth channel. The
/// same values give the same bytes on every run. Errors: ExitCode::output, also when the disk is
/// full.
void write_image(const SafeFile& file, const ImageSpec& spec, std::span<const float> values);

}  // namespace ssdo
