// SPDX-License-Identifier: Apache-2.0
//
// The passes of bounces of method bitmask (see bitmask.cpp). Each is lit by the one before.
//
// Light is linear: where layers of each light are wanted, each is sent on and gathered alone, by
// the same slices, masks and rays, and its next pass is lit by its own. Two things depend on how
// bright a sender is, and are decided by all lights together: what rays gather in place of the
// march (rays/emitters.h), and what goes on beyond the border (border/border_light.h). So the sum
// over the lights is the light of all, up to the rounding of pack_bf16x2(), which make_add_up()
// takes out.
#pragma once

#include <vector>

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/raster.h"
#include "estimators/estimator.h"
#include "scene/light/light_group.h"
#include "scene/scene.h"

namespace ssdo {

/// What the passes look at.
struct BounceInputs {
  const Scene& scene;
  const Request& request;
  const Progress& progress;
  const Raster& raster;
  const March& march;
  const InterleavedPlane& ao;
  const InterleavedColorRatios* sky;  ///< as InterleavedVisibility has it
  const std::vector<SourceVisibility>& sources;
  const InterleavedPlane* change;  ///< as SenderJob has it
  const OverviewRaster*
      keep_in;  ///< the order in which bands of the frame need what is sent; or null
};

/// What has arrived after the last pass.
struct BouncedLight {
  InterleavedVectors bounce;
  InterleavedVectors emitted;  ///< the part of it that rays have found; empty: none
  glm::vec3 sent{0};           ///< mean radiance that was sent for it
};

struct BouncedLights {
  BouncedLight all;
  std::vector<BouncedLight> each;   ///< where Request::by_light asks for it
  InterleavedPlane error;           ///< of all; empty where it is not wanted
  std::vector<OverviewLight> kept;  ///< what was sent, by pass, where `keep_in` asks for it
};

BouncedLights gather_bounces(const BounceInputs& inputs);

/// Scales the planes of lights, of one size or empty, so that their sum becomes `of_all`: senders
/// are rounded light by light (pack_bf16x2()).
void make_add_up(std::vector<LightProducts>& lights, Plane<glm::vec3> LightProducts::*plane,
                 const Plane<glm::vec3>& of_all);

/// Whether specular light includes light of surfaces of the frame: their light is known.
bool mirrors_surfaces(const Scene& scene, const Request& request);

/// How often light is sent on: by bounces, then to what mirrors it.
int times_sent(const Scene& scene, const Request& request);

/// Whether the sides of a surface send different light.
bool sends_two_sided(const Scene& scene);

/// The radiance that pixels of a part of the raster send of one light, or of all, as SenderJob has
/// it. `before`: what has arrived of it so far; null: none.
InterleavedVectors sent_light(const BounceInputs& inputs, const LightGroup& light,
                              const Window& part, const BouncedLight* before);

/// A part of the raster with what may send light to it in so many bounces.
Window with_senders(const MarchScene& scene, const Request& request, const Window& part,
                    int bounces);

/// What arrives of one light, or of all. `sky` as InterleavedVisibility has it.
InterleavedVisibility visibility_of(const LightGroup& light, const InterleavedPlane& ao,
                                    const InterleavedColorRatios* sky,
                                    const std::vector<SourceVisibility>& sources);

}  // namespace ssdo
