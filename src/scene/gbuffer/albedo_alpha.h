// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/gbuffer.h"

namespace ssdo {

/// Turns the albedo of partly covered pixels into that of their surface, 0..1 where it was stored
/// as 0..1. Finds by the fully covered pixels beside them whether it is premultiplied by alpha;
/// `stated`, or `known` from all of the frame, decides where it is given. Sets
/// `encodings.albedo_premultiplied`, and `albedo_alpha` where it makes a difference.
void undo_alpha_of_albedo(GBuffer& gbuffer, std::optional<bool> stated,
                          const std::optional<Encodings>& known);

}  // namespace ssdo
