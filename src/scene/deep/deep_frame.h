// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "io/exr/deep_reader.h"
#include "scene/gbuffer/read_gbuffer.h"

namespace ssdo {

/// Reads a deep image and undoes the encoding of its depths: they are planar or ray depths in scene
/// units from here on. Depths that are negative throughout are coordinates along the axis: their
/// sign is turned. Samples whose depth or alpha is no number are counted, and show nothing.
/// Warnings go to `warnings`. Errors: those of read_deep.
DeepImage read_deep_frame(const ExrReader& file, const DeepChannels& channels,
                          const GBufferOptions& options, std::vector<std::string>& warnings);

/// The pixels with a sample whose depth or alpha is no number.
std::size_t broken_pixels(const DeepImage& image);

/// Depth from which on the samples of a deep image show nothing.
float farthest_sample(const GBufferOptions& options);

/// The depth of the first solid of every pixel, over the image's window; infinite where there is
/// none.
Plane<float> nearest_surfaces(const DeepImage& image, float far);

}  // namespace ssdo
