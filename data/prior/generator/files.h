// SPDX-License-Identifier: Apache-2.0
//
// The two files of a frame: frame_#####.exr and truth_#####.bin.
#pragma once

#include <string>

#include "ray_cast.h"

struct FrameHeader {
  float family, up_axis;  // 1: y, 2: z
  float ortho, half_width, half_height;
  float scale;                // file units per metre
  float sun[3];               // towards the sun, in the axes of the file
  float id, attempt, pixels;  // number of rows that follow
};

/// A G-buffer with Blender's layer names, float, uncompressed: P and N in world space, planar
/// depth (background 1e10), albedo as DiffCol. Points are scaled; z is up, or y if up_axis is 1.
void write_frame(const std::string& path, const Frame& frame, const FrameHeader& header);
/// The header, then rows of Truth, all float32 little-endian.
void write_truth(const std::string& path, const std::vector<Truth>& rows,
                 const FrameHeader& header);
/// From z up to the axes of the file.
Vec file_axes(Vec v, const FrameHeader& header);
