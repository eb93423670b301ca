// SPDX-License-Identifier: Apache-2.0
//
// Lamps that are linked to objects, as the collections lightLink and shadowLink of UsdLux do it:
// `receive` selects what a lamp lights, `cast` what blocks its light.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "relight/frame.h"
#include "relight/known_geometry.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// What a lamp lights, by pixel of the geometry; null: everything. Its selections become those of
/// this frame, and their files are opened. `number` is the frame's in its sequence. Errors: those
/// of selected_coverage().
std::shared_ptr<const Plane<float>> find_receivers(Frame& frame, Lamp& lamp, int number,
                                                   bool allow_partial);

/// How the solids of a frame are found.
struct SolidOptions {
  std::optional<float> thickness;
  const GBufferOptions& reading;
};

/// What lamps are linked to, with files of the frame of this number.
LampLinks links_of(const std::vector<Lamp>& lamps, int number);

/// What does not block the light of a lamp, as ExcludedObjects::coverage: the surfaces of a frame
/// that its selection does not cover, and those of `out`, which may be empty.
Plane<float> all_but(const Plane<float>& selected, const Plane<float>& out, const Geometry& frame);

/// Fills Scene::linked_occluders of a scene of the frame: of what the frame and the views of
/// `known` show, only what a lamp of Frame::lamps selects is kept, without `out`. Edges between
/// selected objects and background are kept. Surfaces behind the rest are found as behind objects
/// that cast nothing. Errors: those of selected_coverage().
void find_linked_occluders(Frame& frame, const KnownGeometry& known, const ExcludedObjects& out,
                           const SolidOptions& options, Scene& scene);

}  // namespace ssdo
