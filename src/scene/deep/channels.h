// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "io/exr/deep_reader.h"

namespace ssdo {

/// Whether a file has a deep part.
bool has_deep_part(const ExrReader& file);

/// The channels of a file's deep parts that say where something is: Z, ZBack and A of one layer, or
/// of a part without layers; ZBack and A may also stand in another layer of that part, or in
/// another deep part. `wanted` is empty, or a part by name or number, or a view. Nothing where the
/// file has no deep part, or none that is wanted. Errors: ExitCode::layer where none of them has a
/// Z, or several have.
std::optional<DeepChannels> find_deep_channels(const ExrReader& file, const std::string& wanted);

}  // namespace ssdo
