// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/exr_reader.h"
#include "math/plane.h"

namespace ssdo {

/// FILE or FILE:LAYER.
struct PictureName {
  std::string file;
  std::string layer;  ///< empty: none is named
};

/// Splits at the last colon where the whole text names no file.
PictureName parse_picture_name(const std::string& text);

/// Channels that belong together: those of one part up to the last dot of their names.
struct PictureLayer {
  int part = 0;
  std::string name;  ///< "" for channels without a dot, else "ViewLayer.DiffDir"
  std::string part_name;
  std::vector<std::string> channels;    ///< full names, in the order X Y Z or R G B A
  std::vector<std::string> components;  ///< what follows the last dot
};

/// The layers of an EXR, or the one layer R G B of any other image.
class LayeredPicture {
 public:
  /// Errors: ExitCode::input.
  explicit LayeredPicture(const std::string& file);

  const std::string& file() const { return file_; }
  const std::optional<ExrReader>& exr() const { return exr_; }
  const std::vector<PictureLayer>& layers() const { return layers_; }

  /// The layer of that name: in full, behind a part's name and a dot, or its last words
  /// ("DiffDir"); or the one channel of that name. Errors: ExitCode::layer where there is none, or
  /// several.
  PictureLayer find(const std::string& name) const;

  /// The window that a layer covers.
  Window window(const PictureLayer& layer) const;
  std::vector<Plane<float>> read(const PictureLayer& layer) const;

 private:
  std::string names() const;

  std::string file_;
  std::optional<ExrReader> exr_;
  std::vector<PictureLayer> layers_;
  std::vector<Plane<float>> image_;  ///< of what is no EXR
};

/// How a layer is called in messages and tables.
std::string shown_name(const PictureLayer& layer);

}  // namespace ssdo
