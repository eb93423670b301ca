// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "io/images/image_file.h"
#include "io/pictures/transfer_curve.h"
#include "math/pixel_grid.h"
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

/// The layers of an EXR, or the one layer R G B, with A where there is an alpha, of any other
/// image.
class LayeredPicture {
 public:
  /// Errors: ExitCode::input, also for deep images.
  explicit LayeredPicture(const std::string& file);

  const std::string& file() const { return file_; }
  const std::optional<ExrReader>& exr() const { return exr_; }
  const std::vector<PictureLayer>& layers() const { return layers_; }

  /// The names of all layers, for messages.
  std::string names() const;

  /// Whether the image is no EXR and stores integers, which become 0..1.
  bool integers() const { return image_.integers; }

  /// How the colours of a layer are encoded, where they are not linear.
  std::optional<TransferCurve> curve(const PictureLayer& layer) const;

  /// The layer of that name, or the one channel: by its full name ("ViewLayer.DiffDir", "Z"), also
  /// behind a part's name and a dot; else by its last words ("DiffDir").
  /// Errors: ExitCode::layer where there is none, or several.
  PictureLayer find(const std::string& name) const;

  /// The window that a layer covers, and the one that it is shown in.
  Window window(const PictureLayer& layer) const;
  Window display(const PictureLayer& layer) const;

  /// The layer's channels over the rows of its window that `grid` has.
  std::vector<Plane<float>> read(const PictureLayer& layer, const PixelGrid& grid = {}) const;

 private:
  std::string file_;
  std::optional<ExrReader> exr_;
  std::vector<PictureLayer> layers_;
  Image image_;  ///< of what is no EXR
};

/// Whether a file is read as an EXR: by its ending, or as it begins.
bool reads_as_exr(const std::string& file);

/// The curve of an image that is no EXR: of the space that it names; integers without one are in
/// sRGB, as in OpenImageIO and Nuke.
std::optional<TransferCurve> curve_of(const Image& image);

/// How a layer is called in messages and tables.
std::string shown_name(const PictureLayer& layer);

}  // namespace ssdo
