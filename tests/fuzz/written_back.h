// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/exr/exr_reader.h"

namespace ssdo::fuzz {

/// Writes a product beside the channels of a part, as --keep-channels does. `choices` are those of
/// --crop, --downsample and --compression. The file that comes of it can be read, and what is
/// neither filtered nor filled keeps its bits; it is a finding where that does not hold.
/// Errors: those of ExrWriter.
void write_back(const ExrReader& file, const ExrPart& part, unsigned choices);

}  // namespace ssdo::fuzz
