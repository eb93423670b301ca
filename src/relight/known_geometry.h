// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/exr/deep_reader.h"
#include "relight/frame.h"
#include "scene/other_views/merge.h"
#include "scene/other_views/other_pictures.h"
#include "scene/other_views/other_view.h"
#include "scene/scene.h"

namespace ssdo {

/// What the files of --also and the other eye show of a frame's
/// scene.
struct KnownGeometry {
  std::vector<DeepImage> deep;   ///< of the frame itself
  std::vector<OtherView> views;  ///< of other cameras, in the frame's camera space
  std::vector<std::string> warnings;
  std::vector<std::string> losses;  ///< of the views; see ExrReader::losses()
};

/// Reads what `files` name beside the frame; of another eye that cannot be read, a warning tells.
/// `own` are the deep samples that the frame itself was read from. Errors: those of the stages that
/// read; ExitCode::layer where the frame knows no world space to place other views in.
KnownGeometry read_known_geometry(const Frame& frame, const FrameFiles& files,
                                  const FrameOptions& options, OtherPictures& pictures,
                                  const std::optional<DeepImage>& own);

/// Objects that cast nothing.
struct ExcludedObjects {
  Plane<float> coverage;             ///< of the frame
  Plane<float> backdrop;             ///< 1 where it shows one; may be empty
  unsigned char marks;               ///< OtherPicture::object_flags
  unsigned char marks_of_other_eye;  ///< the same of the other eye, which follows the frame's
                                     ///< answer about a backdrop

  /// The text of a lamp's selection: in other views, all that it does not select is taken out too,
  /// see OtherPicture::casts. Empty: no lamp's.
  std::string cast = {};

  unsigned char marks_of(const OtherView& view) const {
    return view.is_other_eye ? marks_of_other_eye : marks;
  }
};

/// Fills the solids and the surfaces of other views of a scene: measured where deep images or other
/// views show them, guessed elsewhere, or as thick as `thickness`. Returns what each view added,
/// back faces last; the views of back faces are taken out of `known`. Warns of views of another
/// scene, unit or axes. With `excluded`, the surfaces that it covers in the frame, and those that
/// it marks in OtherPicture::object_flags of the views, cast nothing. Errors: ExitCode::layer for a
/// deep image of another frame.
std::vector<MergeCounts> use_known_geometry(KnownGeometry& known, Scene& scene,
                                            std::optional<float> thickness,
                                            const GBufferOptions& reading,
                                            const ExcludedObjects* excluded = nullptr);

}  // namespace ssdo
