// SPDX-License-Identifier: Apache-2.0
//
// Ground-truth ambient occlusion: Jimenez, Wu, Pesce, Jarabo, "Practical Realtime Strategies for
// Accurate Indirect Occlusion", 2016, in the form that engines run. A slice is the plane of the
// view direction v (to the viewer) and a direction s on the screen; t is the unit part of s across
// v. On both sides the steps of a slice, at max(k (j + u), 1 + j) pixels, look for the cosine c of
// the horizon's angle to v, from -1 on. For a surface at a distance d with the cosine C:
//
//   C > c:  c = lerp(C, c, min(2 d^2 / R^2, 1))       else  c = lerp(C, c, thickness)
//
// With n_p the part of the normal in the slice, n its angle to v and h1 = -acos(c1), h2 = acos(c2)
// the angles of both horizons, clamped to within a right angle of n, the open part of the slice is
//
//   |n_p| / 4 sum_h (-cos(2h - n) + cos n + 2 h sin n)
//
// and ao the mean over slices. k is max(min(R / 2 in pixels, 512), steps) / (steps + 1).
//
// The bent normal is the first moment of what is open, with the same weight |n_p| cos(h - n)
// |sin h|. With c1, s1, c2, s2 the cosines and sines of both angles, t along s, C = c1 + c2,
// C3 = c1^3 + c2^3 and S3 = s1^3 + s2^3, that of a slice is
//
//   |n_p| / 3 ((cos n (2 - C3) + sin n S3) v - (sin n (4 - 3 C + C3) + cos n S3) t)
//
// and 2/3 N the mean over all slices where nothing is hidden. A few slices with C = C3 = S3 = 0
// have another mean; the difference, times ao over the ao of the same slices with all open, is
// added. This makes an open surface exact and leaves a closed one without a bent normal.
//
// What differs, and why:
// - Slices turn and steps shift (u) by the 4 x 4 patterns of Jimenez et al., which the filter of
//   the pipeline removes. Engines add one of 6 turns and one of 4 shifts, chosen by the number of
//   the frame; here the seed chooses them. Seed 0 adds nothing, and after 24 seeds each of the 24
//   is moved within its own stratum, by the sequence R2 of Roberts (2018).
// - A step sees the surface in the centre of its pixel, where engines take the depth of that pixel
//   for another place. Surfaces that are not above the tangent plane by more than the precision of
//   P and N do not raise the horizon: they hide nothing, and a tilted plane does not hide itself.
// - What is outside the frame or background has C = -1.
// - Pixels that are not square are taken into account.
// - Left out are the engines' exponent of 2.5 and intensity on ao, its fade with distance, and
//   that the bent normal is turned away from the viewer: they have no meaning in light.
// - Engines add unit vectors at the angles (h1 + h2) / 2 for the bent normal. That has another
//   weight than ao: of an open plane it is as much as 24 degrees off N, with any number of slices.
//
// Known faults, kept: horizons see one layer, and with thickness 1 whatever is in front is
// endlessly thick; the falloff lets near occluders pass some light; the reach on the screen is
// half the radius; two steps miss what is small; a few slices give too little light, or too much,
// where a surface is seen at a grazing angle.
//
// The direct light is the irradiance of the bent normal times ao, or with `multi-bounce` times what
// multi_bounce.h makes of ao and the albedo. This stands for bounces, so the method makes no bounce
// light of its own.
#include "estimators/gtao.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "estimators/view_space/ambient_light.h"
#include "estimators/view_space/multi_bounce.h"
#include "estimators/view_space/openness.h"
#include "estimators/view_space/reflection_occlusion.h"
#include "estimators/view_space/tiled_noise.h"
#include "math/sequence_numbers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/gtao.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"
// After the targets' headers.
#include <hwy/contrib/math/math-inl.h>

#ifndef SSDO_GTAO_JOB_
#define SSDO_GTAO_JOB_
namespace ssdo {

/// Sine of the elevation up to which a surface may lie in the tangent plane: the precision of
/// normals in half floats.
constexpr float kFlat = 0.001f;

/// Directions on the screen, y up, by place in the pattern.
struct SliceTurns {
  TiledNoise cosine, sine;
};

struct GtaoJob {
  const ViewPlanes& planes;
  std::vector<SliceTurns> slices;
  TiledNoise first_step;  ///< 0 to 1
  int steps;
  float reach_px;          ///< of the last step at depth 1, or at any where orthographic
  float falloff;           ///< 2 / R^2
  float thinness;          ///< 1 - thickness
  Plane<glm::vec3>& bent;  ///< N times ao where open evenly; empty: not wanted
};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The cosine of the horizon after the surface that lies `right` and `down` whole pixels away has
/// been looked at; `horizon` is the cosine before.
HWY_INLINE V next_horizon(const GtaoJob& job, const ViewReceiver& p, const V3& to_viewer, V right,
                          V down, V horizon) {
  const ViewPlanes& planes = job.planes;
  const V z = gather_depth(planes, pixels_at(planes, p.x + right, p.y + down));
  const V3 to = way_to(planes, p, right, down, z);
  const V distance2 = dot(to, to);
  const M seen = hn::And(distance2 > set(0), distance2 < set(std::numeric_limits<float>::max()));
  const V distance = hn::Sqrt(distance2);
  const V cosine = hn::IfThenElse(seen, dot(to, to_viewer) / distance, set(-1));
  const V flat = hn::MulAdd(set(kFlat), distance, p.rounding);
  const M rises = hn::And(cosine > horizon, dot(to, p.normal) > flat);
  const V falloff = hn::Min(distance2 * set(job.falloff), set(1));
  return hn::IfThenElse(rises, hn::MulAdd(horizon - cosine, falloff, cosine),
                        hn::MulAdd(hn::Min(cosine - horizon, set(0)), set(job.thinness), horizon));
}

/// First moment of a slice's open part between directions of these cosines to the viewer, times
/// 3/2. `upright` and `aside` are |n_p| cos n and |n_p| sin n.
HWY_INLINE V3 moment_of(V upright, V aside, V cos1, V cos2, const V3& to_viewer,
                        const V3& tangent) {
  const auto cubed = [](V v) HWY_ATTR { return v * v * v; };
  const auto sine = [](V cosine) HWY_ATTR {
    return hn::Sqrt(hn::Max(hn::NegMulAdd(cosine, cosine, set(1)), set(0)));
  };
  const V cubes = cubed(cos1) + cubed(cos2), sine_cubes = cubed(sine(cos2)) - cubed(sine(cos1));
  const V along = hn::MulAdd(upright, set(2) - cubes, aside * sine_cubes);
  const V across = hn::MulAdd(aside, set(4) - set(3) * (cos1 + cos2) + cubes, upright * sine_cubes);
  return mul_add(to_viewer, along * set(0.5f), tangent * (across * set(-0.5f)));
}

HWY_INLINE V acos_of(V cosine) { return hn::Acos(D(), hn::Min(hn::Max(cosine, set(-1)), set(1))); }

void gtao_of_tile(const GtaoJob& job, const Tile& tile, Plane<float>& ao) {
  const D d;
  const ViewPlanes& planes = job.planes;
  const V steps = set(float(job.steps)), share = set(1 / float(job.slices.size()));
  const V stretch = set(planes.fx / planes.fy), right_angle = set(float(std::numbers::pi / 2));
  set_openness(planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const V3 to_viewer = direction_to_viewer(planes, p);
    const V reach = length_px(planes, p, job.reach_px);
    const V step = hn::Max(hn::Min(reach, set(512)), steps) / (steps + set(1));
    const V first = load(job.first_step.at(planes, x, y));
    const V upright = dot(p.normal, to_viewer);
    V sum = set(0), sum_if_open = set(0);
    V3 moment = set(glm::vec3(0)), moment_if_open = moment;
    for (const SliceTurns& turn : job.slices) {
      const V turn_x = load(turn.cosine.at(planes, x, y)),
              turn_y = load(turn.sine.at(planes, x, y));
      V cos_ahead = set(-1), cos_behind = set(-1);
      for (int j = 0; j < job.steps; ++j) {
        const V distance = hn::Max(step * (set(float(j)) + first), set(float(1 + j)));
        const V right = hn::Round(turn_x * distance * stretch),
                down = hn::Neg(hn::Round(turn_y * distance));
        cos_ahead = next_horizon(job, p, to_viewer, right, down, cos_ahead);
        cos_behind = next_horizon(job, p, to_viewer, hn::Neg(right), hn::Neg(down), cos_behind);
      }
      const V3 tangent = unit_across({turn_x, turn_y, set(0)}, to_viewer);
      const V aside = hn::Neg(dot(p.normal, tangent));  // angles grow away from the tangent
      const V length = hn::Sqrt(hn::MulAdd(upright, upright, aside * aside));
      const V unit = set(1) / hn::Max(length, set(1e-20f));
      const V cos_n = upright * unit, sin_n = aside * unit;
      const V n = hn::CopySign(acos_of(cos_n), aside);
      const V h1 = hn::Max(hn::Neg(acos_of(cos_ahead)), n - right_angle),
              h2 = hn::Min(acos_of(cos_behind), n + right_angle), both = h1 + h2;
      const V arc = set(2) * hn::MulAdd(both, sin_n, cos_n) - hn::Cos(d, h1 + h1 - n) -
                    hn::Cos(d, h2 + h2 - n);
      sum = hn::MulAdd(length * set(0.25f), arc, sum);
      if (job.bent.empty()) continue;
      // The clamped angles are a right angle from n: their cosines are sin n and -sin n.
      moment = moment + moment_of(upright, aside, hn::Max(cos_ahead, sin_n),
                                  hn::Max(cos_behind, hn::Neg(sin_n)), to_viewer, tangent);
      moment_if_open = moment_if_open + mul_add(to_viewer, upright, tangent * (set(-2) * aside));
      sum_if_open = hn::MulAdd(length, hn::MulAdd(n, sin_n, cos_n), sum_if_open);
    }
    if (!job.bent.empty()) {
      const V open = sum / hn::Max(sum_if_open, set(1e-20f));
      const V3 bent = mul_add(p.normal, open, (moment - moment_if_open * open) * share);
      store_first(tile.x1 - x, bent * hn::IfThenElseZero(p.valid, set(1)), &job.bent(x, y));
    }
    return sum * share;
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(gtao_of_tile);

namespace {

constexpr int kPattern = TiledNoise::kSize;

/// Parts of a slice's turn and of a step that a seed adds at every pixel, 0 to 1.
struct SeedShift {
  double turn, step;
};

SeedShift shift_of(unsigned seed) {
  constexpr std::array<int, 6> kDegrees = {0, 60, 300, 180, 240, 120};  // engines begin at 60
  constexpr std::array<double, 4> kSteps = {0, 0.5, 0.25, 0.75};
  const unsigned round = seed / 24;
  return {kDegrees[seed % 6] / 360.0 + fraction(round * kR2First) / 6,
          kSteps[seed / 6 % 4] + fraction(round * kR2Second) / 4};
}

/// Slice `i` of `count` through each pixel of the pattern.
SliceTurns turns_of(int i, int count, double shift) {
  std::array<float, kPattern * kPattern> cosine, sine;
  for (int y = 0; y < kPattern; ++y) {
    for (int x = 0; x < kPattern; ++x) {
      const double turn = fraction(((x + y) % kPattern * kPattern + x) / 16.0 + shift),
                   angle = (i + turn) * std::numbers::pi / count;
      cosine[std::size_t(y * kPattern + x)] = float(std::cos(angle));
      sine[std::size_t(y * kPattern + x)] = float(std::sin(angle));
    }
  }
  return {TiledNoise(cosine), TiledNoise(sine)};
}

TiledNoise first_steps(double shift) {
  std::array<float, kPattern * kPattern> first;
  for (int y = 0; y < kPattern; ++y) {
    for (int x = 0; x < kPattern; ++x) {
      const double step = 0.25 * ((y - x + kPattern) % kPattern);
      first[std::size_t(y * kPattern + x)] = float(fraction(step + shift));
    }
  }
  return TiledNoise(first);
}

void normalise_all(Plane<glm::vec3>& vectors) {
  for (glm::vec3& v : vectors.pixels) {
    const float length = glm::length(v);
    v = length > 0 ? v / length : glm::vec3(0);
  }
}

Plane<glm::vec3> direct_light(const Scene& scene, const Products& found, bool bounces) {
  if (!bounces) return ambient_light(scene, found.ao, &found.bent);
  const Plane<float> open(found.ao.width, found.ao.height, 1.0f);
  Plane<glm::vec3> direct = ambient_light(scene, open, &found.bent);
  for (std::size_t i = 0; i < direct.size(); ++i)
    direct[i] *= multi_bounce(found.ao[i], scene.senders.albedo[i]);
  return direct;
}

Products estimate_gtao(const Scene& scene, const Request& request, const Progress& progress) {
  const auto parameter = [&](const char* name) { return request.parameters.find(name)->second; };
  const int slices = int(parameter("slices"));
  const bool bounces = parameter("multi-bounce") != 0;
  const ViewPlanes planes = make_view_planes(scene.geometry);
  Products out;
  if (request.products.bent || request.products.direct || request.products.reflection)
    out.bent = Plane<glm::vec3>(planes.width(), planes.height(), glm::vec3(0));
  const SeedShift shift = shift_of(request.seed);
  std::vector<SliceTurns> turns;
  for (int i = 0; i < slices; ++i) turns.push_back(turns_of(i, slices, shift.turn));
  const GtaoJob job{planes,
                    std::move(turns),
                    first_steps(shift.step),
                    int(parameter("steps")),
                    planes.fy * request.radius / 2,
                    float(2 / (double(request.radius) * double(request.radius))),
                    float(1 - parameter("thickness")),
                    out.bent};
  out.ao = find_openness(planes, progress, [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(gtao_of_tile)(job, tile, ao);
  });
  if (request.products.reflection)
    out.reflection = reflection_occlusion(scene, request, planes, out.bent,
                                          float(parameter("reflection-strength")));
  normalise_all(out.bent);
  if (request.products.direct) out.direct = direct_light(scene, out, bounces);
  if (!request.products.bent) out.bent = {};
  return out;
}

}  // namespace

Method gtao_method() {
  return {
      .name = "gtao",
      .summary = "horizons in slices with the cosine, Jimenez et al. 2016",
      .products = {.ao = true, .direct = true, .bent = true, .reflection = true},
      .supports = {.radius = true},
      .pattern_size = kPattern,
      .published_filter = {"geometry"},
      .parameters =
          {
              {"slices", 2, 1, 64, "", "per pixel", true},
              {"steps", 2, 1, 256, "", "per side of a slice", true},
              {"thickness", 1, 0, 1, "", "share of a horizon that lower surfaces beyond it leave"},
              {"multi-bounce", 0, 0, 1, "",
               "1: direct with light between surfaces, by their albedo", true},
              kRoughness,
              {"reflection-strength", 0.5, 0, 1, "", "1/2: an open surface sees a half-ball"},
          },
      .samples_per_pixel =
          [](const Request& r) {
            return 2 * int(r.parameters.at("slices")) * int(r.parameters.at("steps"));
          },
      .estimate = estimate_gtao,
      .ladder = {.rungs = {slices_and_steps(1, 2), slices_and_steps(2, 2), slices_and_steps(3, 4),
                           slices_and_steps(6, 8)},
                 .limit = slices_and_steps(16, 32),
                 .seeds = 6},
  };
}

}  // namespace ssdo
#endif
