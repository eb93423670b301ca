// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace ssdo {

/// Throws ExitCode::input for a PNG that is cut short, or has a damaged signature or chunk. libpng
/// prints a line of its own about these before OpenImageIO has its error. Files of other kinds are
/// not looked at, nor are chunks without which a picture can be shown. Source: PNG specification
/// 1.2, section 3.
void check_png_chunks(const std::filesystem::path& file);

}  // namespace ssdo
