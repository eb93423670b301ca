// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "color/color.h"
#include "io/exr/exr_reader.h"
#include "plan/band_plan.h"
#include "plan/explain.h"
#include "plan/outputs.h"
#include "plan/plan.h"
#include "relight/frame_options.h"
#include "relight/lighting.h"
#include "scene/camera/world_up.h"
#include "scene/gbuffer.h"
#include "scene/layers/layers.h"
#include "scene/objects/selected_coverage.h"
#include "scene/other_views/merge.h"
#include "scene/other_views/other_pictures.h"
#include "scene/scene.h"
#include "scene/view.h"

namespace ssdo {

/// Milliseconds of wall time per stage; `known` is what --also takes, with the solids that it
/// changes.
struct StageTimes {
  double read = 0, known = 0, prepare = 0, estimate = 0, filter = 0, compose = 0, write = 0;
};

/// What is known of a lamp beside its light.
struct LampOfFrame {
  std::string given_by;     ///< Lamp::given_by
  bool is_local;            ///< it has a position
  std::size_t source;       ///< its number in Light::sources
  Selection cast, receive;  ///< with files of this very frame
  /// Makes its source once more, for a band: the band sets what `receive` selects in its rows.
  std::function<std::shared_ptr<Source>()> make;
};

/// A frame that has been read and understood: all that stands before the first estimate.
struct Frame {
  std::string input;
  std::string view;             ///< of a stereo file; empty: it shows one
  std::deque<ExrReader> files;  ///< the frame, those of --aov, then those of selections
  ObjectOptions objects;        ///< with files of this very frame
  LayerTable layers;
  Scene scene;
  GBuffer gbuffer;  ///< what the scene has not taken: layers as rendered, alpha, motion
  GeometryReport report;
  /// Whether a surface is of a backdrop that casts nothing; null: there is none.
  std::function<bool(const Surfel&)> is_backdrop;
  /// What has the shape of a backdrop, and casts; empty: nothing.
  std::string near_backdrop;
  /// What other views add: those of --also, then back faces.
  std::vector<MergeCounts> views;
  std::string light;                         ///< one line
  std::map<std::string, LampOfFrame> lamps;  ///< by name
  std::optional<glm::vec3>
      up;  ///< unit, camera space; found for a learned prior, where it is known
  Plan plan;
  GuessedShare guessed;
  std::vector<std::string> history;  ///< what a temporal plan takes from the frame before, and why
  std::vector<std::string> losses_of_views;  ///< of other views; see ExrReader::losses()
  StageTimes times;                          ///< of the stages up to here
  /// Set for a frame that is larger than memory: the scene and what is left of the G-buffer then
  /// are an overview of it, one pixel of kOverviewStride x kOverviewStride.
  std::optional<BandPlan> bands;

  /// The layer that the products are made from: position, or depth where there is none.
  const Layer& lead() const;
  const ExrPart& part() const;
  std::vector<const ExrReader*> readers() const;  ///< of all its files, in their order
  std::vector<std::string> warnings() const;
  void warn(const std::vector<std::string>& lines);  ///< adds to the warnings

  /// Where its selections are looked up. An overview of the frame may miss what it shows: then no
  /// name is warned of.
  SelectionFiles selections(std::vector<std::string>& warnings) const {
    return {files, view, gbuffer.grid.is_coarse() ? nullptr : &warnings};
  }

  /// What --allow-partial has found missing so far, in files of the frame and of other views: a
  /// line each. Rows may be read, and channels kept, until the outputs are written.
  std::vector<std::string> losses() const;
};

/// What a scene takes of a G-buffer with this geometry: albedo and radiance of the senders,
/// roughness and the colour of mirrors, which are moved. What lies behind the surfaces, and the
/// light, are left to be found.
Scene take_scene(GBuffer& gbuffer, Geometry geometry);

/// What the header of the frame's part says about colour.
ColorTags color_tags(const Frame& frame);

}  // namespace ssdo
