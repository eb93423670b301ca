// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace ssdo {

/// Throws ExitCode::input where an attribute in the headers of an EXR claims more bytes than the
/// file has, another size than its value takes, or more channels than any renderer writes. OpenEXR
/// allocates what is claimed, up to 2 GiB, before it reads. Other defects of headers are left to
/// OpenEXR, which has messages for them. Source: OpenEXR file layout, "Header".
void check_attribute_sizes(const std::filesystem::path& file);

}  // namespace ssdo
