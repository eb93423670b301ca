// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace ssdo {

/// Refuses to allocate what a damaged header claims. Throws ExitCode::input if `pixel_bytes`, the
/// decoded pixels, are more than a file of the size of `file` can hold, or if they and
/// `working_bytes` exceed the machine's memory.
void check_decoded_size(const std::filesystem::path& file, double pixel_bytes,
                        double working_bytes = 0);

}  // namespace ssdo
