// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/gbuffer.h"

namespace ssdo {

/// Undoes the encoding of the normals as 0..1, or with a gamma, and says so in the warnings. The
/// encoding is the one that decodes to unit length.
/// `known` is that of the frame of which `g` is a part.
void undo_normal_encoding(GBuffer& g, const std::optional<Encodings>& known);

}  // namespace ssdo
