// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/exr/deep_reader.h"
#include "io/exr/exr_reader.h"
#include "scene/gbuffer.h"
#include "scene/gbuffer/read_gbuffer.h"
#include "scene/geometry.h"
#include "scene/layers/layers.h"
#include "scene/objects/object_options.h"

namespace ssdo {

/// Which files and layers are read, and how.
struct InputOptions {
  std::vector<LayerRequest> aovs;
  std::vector<std::string> also;   ///< other pictures of the same scene, or their patterns
  std::string part;                ///< name or number; empty: all
  std::vector<std::string> views;  ///< those to relight of a stereo file; empty: its only one
  std::string view;                ///< of them, the one that is read
  GBufferOptions gbuffer;
  ObjectOptions objects;
  bool allow_partial = false;  ///< take what is there of files with missing chunks
  bool listed = false;  ///< the user has seen the list of layers: errors need not say where it is
};

/// The files that a frame is made from. Patterns are replaced by the number of the frame.
struct FrameFiles {
  std::string input;
  std::vector<LayerRequest> aovs;
  std::vector<std::string> also;  ///< other pictures of the same scene, in the order of --also
  std::string view = {};          ///< of a stereo file; empty: --part chooses
  ObjectOptions objects = {};
  LampLinks links = {};  ///< of lamps
};

/// The frame with a view of its files.
FrameFiles in_view(FrameFiles files, std::string_view view);

/// The frame as its other eye sees it. `files` have a view.
FrameFiles other_eye(const FrameFiles& files);

/// `options` for these files: with their view.
InputOptions for_view(InputOptions options, const FrameFiles& files);

/// What one camera shows: a G-buffer, from its files to its surfaces in camera space.
struct View {
  std::deque<ExrReader> files;  ///< the frame, then the files that --aov names
  LayerTable layers;
  std::optional<DeepImage> deep;  ///< what the depth was taken from, where there is no other
  GBuffer gbuffer;  ///< without position, normal, depth and valid: the geometry has them
  Geometry geometry;
  GeometryReport report;
  double read_ms = 0;  ///< wall time of what was read, without the geometry
};

/// The file `input`, then the files that `aovs` name; with `allow_partial`, their missing chunks
/// are no errors. Errors: those of ExrReader.
std::deque<ExrReader> open_view(const std::string& input, const std::vector<LayerRequest>& aovs,
                                bool allow_partial = false);

/// Reads what open_view() has opened: layers, gbuffer, camera, geometry. `aovs` are the requests
/// for layers, with files of this very frame. The roles in `unused` are filled on request only.
/// Errors: those of the stages.
View read_view(std::deque<ExrReader> files, const std::vector<LayerRequest>& aovs,
               const InputOptions& options, const CameraOptions& camera,
               const std::vector<Role>& unused);

}  // namespace ssdo
