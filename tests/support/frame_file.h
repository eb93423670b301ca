// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <filesystem>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "support/analytic_scene.h"
#include "support/exr_fixture.h"

namespace ssdo::test {

/// One part of an EXR that a test makes.
struct FramePart {
  std::string name;
  Window data, display;
  std::map<std::string, Plane<float>> channels;
  Imf::PixelType type = Imf::FLOAT;
  Imf::Header extra;  ///< attributes to take over
  int tile_size = 0;  ///< 0: scanlines

  /// Adds a channel for each component.
  void add(const std::string& layer, const Plane<glm::vec3>& values,
           const std::string& components = "XYZ");
};

/// P, N, albedo 1/2 and depth of a picture, under the names that Blender uses.
FramePart frame_of(const Picture& picture, const std::string& prefix = "ViewLayer.");

void write_frame(const std::filesystem::path& path, const std::vector<FramePart>& parts);

void write_frame(const std::filesystem::path& path, const FramePart& part);

/// Ground and a sphere, seen from above: small, and enough to fit a camera to.
Picture small_picture(const Window& window = {0, 0, 64, 48},
                      const Window& display = {0, 0, 64, 48});

/// One channel of an EXR.
Plane<float> channel(const std::filesystem::path& path, const std::string& name, int part = 0);

std::vector<std::string> channel_names(const std::filesystem::path& path, int part = 0);

}  // namespace ssdo::test
