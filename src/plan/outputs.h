// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "color/composition.h"
#include "io/exr/exr_writer.h"
#include "io/files/safe_file.h"

namespace ssdo {

/// A product and the file that it alone goes to.
struct SaveRequest {
  std::string product, path;
};

struct OutputOptions {
  std::vector<std::string> files;     ///< -o
  std::vector<SaveRequest> saves;     ///< --save
  std::vector<std::string> products;  ///< empty: all that the inputs allow
  std::optional<Compose> compose;     ///< chosen by the layers where not given
  Imf::PixelType pixel_type = Imf::HALF;
  std::optional<Imf::Compression> compression;  ///< the input's where not given
  std::optional<int> compression_level;         ///< its own default where not given
  int bits = 8;                                 ///< per channel of PNG and TIFF: 8 or 16
  bool per_light = false;  ///< EXR outputs hold the layers of each light beside those of all
  bool keep_channels = false;
  bool crop = false;    ///< EXR outputs hold the display window only
  int downsample = 1;   ///< how many times as large as the outputs the frame is: 1 to 8
  std::string made_by;  ///< of --history, for the header of EXR outputs; empty: not asked for
  OutputPolicy policy;
};

/// A file to write: every product of the plan, or one.
struct Target {
  std::string path;
  std::optional<std::string> product;  ///< --save
  std::string view = {};               ///< that it shows; empty: all that are relit

  bool shows(const std::string& a_view) const { return view.empty() || view == a_view; }
};

}  // namespace ssdo
