// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "estimators/bitmask/border/offscreen_visibility.h"
#include "estimators/bitmask/march.h"
#include "estimators/bitmask/rays/emitters.h"
#include "estimators/bitmask/rays/ray_pattern.h"
#include "estimators/other_views/other_view_light.h"
#include "math/half_color.h"
#include "scene/light/light.h"

namespace ssdo {

class GuessedRays;
struct MirrorModel;

/// The visibility of each pixel, and how much of the light reaches it.
struct VisibilityJob {
  March march;
  /// Order of the spherical harmonics in which light is gathered, up to 4; 0: visibility only.
  int order = 0;
  /// Weights of the basis polynomials, (order + 1)^2 for red, then green, then blue.
  const float* light = nullptr;       ///< null: the same from all directions
  const Light* unoccluded = nullptr;  ///< sky and sources; read only if `difference` is set
  float through_beyond = 0;           ///< share of light that passes surfaces beyond the frame

  InterleavedPlane* ao = nullptr;
  InterleavedPlane* open_ao = nullptr;  ///< if surfaces end at the border; null: not wanted
  InterleavedVectors* bent = nullptr;   ///< unit; null: not wanted
  /// The share of the light that arrives, less ao, by channel: 0, without rounding, for light of
  /// one colour that is the same from everywhere. Null: not wanted.
  InterleavedColorRatios* sky_share = nullptr;
  InterleavedPlane* difference =
      nullptr;  ///< standard error of the direct light's luminance, signed; null: not wanted
};

/// The unit, in pixels, in which widths of penumbras are stored; 32 pixels at most.
inline constexpr float kPenumbraUnit = 8;

/// What rays to a source have found. `share`: the share of the source's light that arrives, about
/// 0..1, as if it met any normal; `weight` and `width`: as in ShadowSample, with widths over
/// kPenumbraUnit.
struct SourceVisibility {
  explicit SourceVisibility(const Interleaving& layout)
      : share(layout), weight(layout), width(layout) {}

  InterleavedRatios share, weight, width;
  InterleavedRatios unseen = {};  ///< what arrives at the sides that the camera does not see, as
                                  ///< `share`; empty: their share of this source is that of the sky
};

/// How much of the light arrives at each pixel, as LightVisibility has it.
struct InterleavedVisibility {
  const Light& light;
  const InterleavedPlane* ao;
  const InterleavedColorRatios* sky;  ///< as VisibilityJob has it; null: ao is the share of all
                                      ///< light
  std::vector<const SourceVisibility*> sources;  ///< as in `light`
};

/// The radiance that each pixel sends to others, and that of its back side.
struct SenderJob {
  const MarchScene& scene;
  InterleavedVisibility found;
  const Plane<HalfColor>& albedo;
  const InterleavedVectors* bounce;  ///< that has arrived so far; null: none
  const InterleavedPlane* change;    ///< of ao, as LearnedVisibility has it; null: none
  glm::vec3 sent_before;             ///< the mean radiance that has given the bounce
  InterleavedVectors* sent;
  bool two_sided;  ///< `sent` holds front and back, as pack_bf16x2(); else they send the same
};

/// What the pixels that march have gathered.
struct GatheredLight {
  GatheredLight(const March& march, bool with_error)
      : layout(march.scene.layout, march.pattern.spacing()),
        sum{InterleavedPlane(layout), InterleavedPlane(layout), InterleavedPlane(layout)},
        weights(layout) {
    if (with_error) error = InterleavedPlane(layout);
  }

  SparseInterleaving layout;
  InterleavedVectors sum;    ///< of weighted radiance
  InterleavedPlane weights;  ///< their sum
  InterleavedPlane error;    ///< of the luminance of the mean radiance, times the weights
};

/// The light that each pixel receives from the first surface in every direction: the mean radiance
/// of what hides the environment, times 1 - ao.
struct BounceJob {
  March march;
  const InterleavedPlane* ao;
  /// The radiance that layer 0 sends; spread_bounce() replaces it by the light that arrives.
  InterleavedVectors* light;
  /// What layer 0 sends of all lights together, of which `light` may be one: this decides what rays
  /// gather and what the march gathers.
  const InterleavedVectors* of_all;
  bool two_sided;                        ///< as SenderJob has it
  const Solids& solids;                  ///< of the scene: whose light layers 1, 2, ... send
  const BorderValues* sent_border;       ///< three: of surfaces that continue beyond the frame
  const std::vector<LampBeyond>& lamps;  ///< whose light `sent_border` lacks
  const OtherViewLight* sent_by_others;  ///< of what only other views show
  Window lit;                            ///< the pixels of the raster whose `sent` is known
  const OverviewScene* overview;         ///< gives the light of the others; null: all are lit
  const OverviewLight* far;              ///< what the overview sends
  const OverviewLight* far_of_all;       ///< the same as `of_all`
  const Emitters* emitters;              ///< whose light rays gather; null: there are none

  GatheredLight* gathered;
  InterleavedPlane* error;  ///< standard error of the luminance of what arrives, signed; null: not
                            ///< wanted
};

/// The light of bright senders, which is added to that of the march.
struct EmittedJob {
  March march;
  const std::vector<DepthBounds>& bounds;
  const Emitters& emitters;
  int rays;  ///< of each pixel, a power of two
  unsigned seed;
  InterleavedVectors* light;    ///< that has arrived so far
  InterleavedVectors* emitted;  ///< the same alone; null: not wanted
  InterleavedPlane* error;      ///< as BounceJob has it, to be added to; null: not wanted
};

/// The direct light of each pixel.
struct DirectJob {
  const MarchScene& scene;
  InterleavedVisibility found;
  InterleavedVectors* direct;
};

/// How much of the light of a source arrives.
struct SourceJob {
  March march;
  const std::vector<DepthBounds>& bounds;
  const std::vector<PointsOfSource>& points;  ///< that each ray goes to
  const Source& source;
  OffscreenVisibility offscreen;
  const InterleavedPlane* unblocked =
      nullptr;  ///< by pixel, where pass.unblocked is 0; null: of none
  /// If set, SourceVisibility::unseen is found, for the solids of this raster, which may differ
  /// from what blocks the light; null: the other members are found.
  const MarchScene* unseen_of = nullptr;
  bool together = true;  ///< as RayTraversal::run(): the same to the bit, and slower without
  SourceVisibility* found = nullptr;
};

/// The light that rough surfaces mirror.
struct MirroredLightJob {
  const MirrorModel& model;
  const Plane<HalfColor>& color;   ///< F0; empty: that of the model
  const InterleavedVectors* sent;  ///< what surfaces send, as SenderJob has it; null: nothing
  bool two_sided;
  const BorderValues* sent_border;  ///< as BounceJob has it; null: nothing
  InterleavedVectors* sky;          ///< the part of the sky's light that is not blocked, by channel
  InterleavedVectors* surfaces;     ///< the mean radiance of surfaces, 0 where none is met
  const GuessedRays* guesses = nullptr;  ///< null: the next two are not wanted
  /// The part of the sky's light, 0..1, that comes along guessed rays, and that of it which `sky`
  /// holds for open.
  InterleavedPlane* guessed = nullptr;
  InterleavedPlane* guessed_open = nullptr;
};

/// How much of what rough surfaces mirror is not blocked.
struct ReflectionJob {
  March march;
  const std::vector<DepthBounds>& bounds;
  const InterleavedPlane* roughness;  ///< 0..1
  int rays;                           ///< of each pixel
  unsigned seed;
  InterleavedPlane* open;         ///< 0..1
  const MirroredLightJob* light;  ///< null: not wanted
};

/// All of these work on a part of the raster, and may write to pixels beside it in the same rows.
void march_visibility(const VisibilityJob& job, const Window& part);
void march_bounce(const BounceJob& job, const Window& part);
/// After march_bounce everywhere.
void spread_bounce(const BounceJob& job, const Window& part);
void march_source(const SourceJob& job, const Window& part);
void march_reflection(const ReflectionJob& job, const Window& part);
/// After spread_bounce of the same pixels. Parts are as for_each_tall_part_of() makes them.
void gather_emitted(const EmittedJob& job, const Window& part);
void find_senders(const SenderJob& job, const Window& part);
void find_direct(const DirectJob& job, const Window& part);

}  // namespace ssdo
