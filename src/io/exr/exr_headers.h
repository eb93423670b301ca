// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>

#include <vector>

#include "io/exr/exr_output.h"
#include "io/exr/kept_channels.h"

namespace ssdo {

/// The headers of an output's parts: those with planes, each with the channels `kept` beside them,
/// and with `keep_channels` the input's other parts, in their order. What is written anew is in
/// scanlines; the header of a part whose chunks are copied is the input's.
/// Errors: ExitCode::input for a part that cannot be cropped.
std::vector<Imf::Header> headers_for(const std::vector<ExrOutput>& parts,
                                     const std::vector<std::vector<KeptChannel>>& kept);

}  // namespace ssdo
