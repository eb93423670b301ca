// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "io/files/safe_file.h"
#include "io/images/image.h"
#include "io/images/kind.h"

namespace ssdo {

/// Loads the module that the functions below need, before work that would be lost without it.
/// Errors: ExitCode::failed where it is missing.
void load_image_codec();

/// Reads a flat image: PNG, JPEG, TIFF or Radiance HDR, whatever the file is called.
/// Errors: ExitCode::input, also for a file that is cut short and that the library would fill up.
Image read_image(const std::filesystem::path& path);

/// Reads the colours of an image as read_image() does, some rows at a time; all at once where its
/// file stores them in another order. Errors: those of read_image() and of `take`.
void read_image_rows(const std::filesystem::path& path, const TakeRows& take);

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
