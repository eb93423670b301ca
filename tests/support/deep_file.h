// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/exr/deep_reader.h"
#include "support/exr_fixture.h"

namespace ssdo::test {

/// The samples of every pixel of a window.
struct DeepPixels {
  Window window;
  std::vector<std::vector<DeepSample>> samples;  ///< row by row

  explicit DeepPixels(const Window& of) : window(of), samples(of.area()) {}
  std::vector<DeepSample>& at(int x, int y) {
    return samples[std::size_t(y - window.y0) * std::size_t(window.width()) +
                   std::size_t(x - window.x0)];
  }
};

/// One deep part of an EXR that a test makes.
struct DeepPart {
  DeepPixels pixels;
  std::string name = {};
  std::string front = "Z", back = "ZBack", alpha = "A";  ///< its channels; empty: not written
  bool tiles = false;
  Imf::PixelType type = Imf::FLOAT;
  Window display = {};  ///< that of the pixels where not given
};

void write_deep(const std::filesystem::path& path, const std::vector<DeepPart>& parts);

/// The image as ssdo reads it, without a file.
DeepImage image_of(const DeepPixels& pixels);

}  // namespace ssdo::test
