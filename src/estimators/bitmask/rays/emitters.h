// SPDX-License-Identifier: Apache-2.0
//
// Small bright senders: what they send that a march of few steps would miss or meet by chance.
//
// A pixel sends the radiance L, in luminance. Rays gather the part of it above a level that the
// frame sets (rays/emitted_light.cpp), and the march gathers the rest (bitmask/bounce.cpp):
//
//   level = 4 (mean of sqrt(L) over the frame's surfaces)^2 / smoothstep(0.05, 0.15, s)
//
// with s the share of the light shown that exceeds this level without the divisor: highlights that
// are little of it stay with the march, whatever it misses of them.
//
// A mean of roots is the level of what is around: a lamp in 1 % of a black frame has a share of
// 1e-4 in it. Where half of the frame is bright, as a lawn in the sun is, nothing exceeds it. Light
// goes over from one part to the other without a step, and both find the same.
//
// Rays go to points that stand for equal shares of the power that exceeds the level. From nearer
// than the size of its area, a point is a poor stand-in for the area, and the march sees the area
// well: of a point of area A at distance d, rays gather the part pi d^2 / (pi d^2 + A), which
// bounds what a point can give as the form factor of a disc is bounded, and the march the rest.
//
// A solid sends from its unseen side as well, as it does in the march (scene/solids/unseen_side.h).
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/bitmask/rays/sent_light.h"

namespace ssdo {

/// A point that light leaves from, in camera space.
struct Emitter {
  glm::vec3 position, normal;  ///< it sends to the side of the normal, unit
  glm::vec3 power;             ///< radiance times the area that it stands for
  float area;                  ///< the area that it stands for
  float solid;           ///< how far before the point, on a ray to it, its own solid may begin
  float per_radiance;    ///< power over the radiance of the pixel that it is taken from
  int pixel;             ///< the index of the radiance of that pixel
  bool is_back, is_far;  ///< whether its back sends; whether it is a pixel of the overview
};

/// What of the light that the pixels of a frame send is gathered by rays.
struct Emitters {
  /// Points that each pixel looks at: a member of the pattern has points of its own, which lie
  /// between those of the others.
  static constexpr int kPoints = 32;

  float bright = 0;             ///< luminance that is bright in the frame: 4 (mean of sqrt(L))^2
  float level = 0;              ///< luminance from which on light is gathered by rays
  float power = 0;              ///< luminance times area that each point stands for
  std::vector<Emitter> points;  ///< kPoints of each member; empty: nothing exceeds the level

  const Emitter* of_member(int member) const { return &points[std::size_t(member * kPoints)]; }
};

/// `seed` exchanges the points of the members.
Emitters find_emitters(const SentLight& sent, unsigned seed);

/// The same points with what they send of one light. `far`: what the overview sends of it. No
/// points: they send nothing of it.
Emitters emitters_of_light(Emitters of_all, const InterleavedVectors& radiance, bool two_sided,
                           const OverviewLight* far);

}  // namespace ssdo
