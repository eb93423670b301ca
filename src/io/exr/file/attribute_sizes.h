// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "io/files/input_file.h"

namespace ssdo {

/// Returns where the headers of an EXR end, in bytes from its begin; the tables of chunks follow.
/// Throws ExitCode::input where an attribute in the headers of an EXR claims more bytes than the
/// file has, another size than its value takes, or more channels than any renderer writes. OpenEXR
/// allocates what is claimed, up to 2 GiB, before it reads. Other defects of headers are left to
/// OpenEXR, which has messages for them. Source: OpenEXR file layout, "Header".
std::uint64_t check_attribute_sizes(const InputFile& file);

}  // namespace ssdo
