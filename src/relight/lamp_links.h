// SPDX-License-Identifier: Apache-2.0
//
// Lamps that are linked to objects, as the collections lightLink and shadowLink of UsdLux do it:
// `receive` selects what a lamp lights, `cast` what blocks its light.
#pragma once

#include <memory>
#include <optional>

#include "relight/frame.h"
#include "relight/known_geometry.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// What a lamp lights, by pixel of the geometry; null: everything. Its selections become those of
/// this frame, and their files are opened. `number` is the frame's in its sequence. Errors: those
/// of selected_coverage(); ExitCode::usage for a frame that is larger than memory.
std::shared_ptr<const Plane<float>> find_receivers(Frame& frame, Lamp& lamp, int number,
                                                   bool allow_partial);

/// How the solids of a frame are found.
struct SolidOptions {
  std::optional<float> thickness;
  const GBufferOptions& reading;
};

/// Fills Scene::blockers of a scene of the frame: what the lamps of Frame::lamps select is left, of
/// what the frame shows, but for `out`; of other views, nothing. An edge
/// between selected things and background is left. What is behind the rest is guessed as of objects
/// that cast nothing. Errors: those of selected_coverage().
void find_blockers(Frame& frame, const TakenOut& out, const SolidOptions& options, Scene& scene);

}  // namespace ssdo
