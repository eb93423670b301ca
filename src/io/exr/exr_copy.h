// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfMultiPartOutputFile.h>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// OpenEXR makes room for chunks as large as a header claims and for as many samples as a deep
/// chunk claims, and reads tiles as long as they claim to be. Throws ExitCode::input where the file
/// or a chunk cannot hold them. To be called before copy_part(), and before the output is opened.
void check_copy(const ExrReader& input, const ExrPart& part);

/// Copies the compressed chunks of a part, flat or deep, into the part of `output` that has the
/// same index and the same header, so that its pixels keep every bit.
/// Errors: ExitCode::input if the part cannot be read; those of the output's stream pass through.
void copy_part(const ExrReader& input, const ExrPart& part, Imf::MultiPartOutputFile& output);

}  // namespace ssdo
