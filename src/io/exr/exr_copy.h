// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfMultiPartOutputFile.h>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// Copies the compressed chunks of a part, flat or deep, into the part of `output` that has the
/// same index and the same header, so that its pixels keep every bit.
/// Errors: ExitCode::input if the part cannot be read; those of the output's stream pass through.
void copy_part(const ExrReader& input, const ExrPart& part, Imf::MultiPartOutputFile& output);

}  // namespace ssdo
