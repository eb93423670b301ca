// SPDX-License-Identifier: Apache-2.0
//
// Horizon-based ambient occlusion: Bavoil, Sainz, Dimitrov, SIGGRAPH 2008, in the two forms of a
// series of lessons on Unity. Its text has the paper's form, without the paper's falloff; its
// listing is Hbao.shader of github.com/lync-li/UnityCrytekSponza-master2019. The text's form:
//
//   ao(p) = max(0, 1 - s / 4 sum_d max(0, max_i sin h - sin(t + asin b)))
//
// v leads from p to the surface in the pixel of a tap, |v| < R; h is its angle and t that of the
// tangent plane below it, both above the plane through p across the view ray. b is the sine of the
// angle above the tangent plane from which on a surface hides, s the strength. Its listing, with
// horizon=taps, has a later form that takes the mean over all taps:
//
//   ao(p) = max(0, 1 - m / (4 S) sum_d sum_i saturate(n.v / |v| - b) saturate(1 - v.v / R^2))
//
// v.v is at least l^2, and m = 2 s / (1 - b), as in published code of this form. In both, tap
// i = 0..S-1 of direction d is round(w (1 + (j + i) step)) pixels away, w at 0, 120, 240 and 90
// degrees plus the angle of the pixel, step = min(disc, cap) / (S + 1), disc the radius R in pixels
// at p. The angle and j repeat every 4 x 4 pixels.
//
// The text's form is the default since it is nearer to path tracing: the error of ao on the seven
// frames of man ssdo-methods is 0.097 and 0.158 at the small and the large radius, and 0.148 and
// 0.247 with the listing's.
//
// disc is the whole radius, as in the paper and the authors' code of 2008. Their later code, which
// the listing comes from, takes half of it; the series' own script takes half of it times the
// picture's width over its height, by mistake, 0.89 at 16:9. It makes little difference: with half
// of it, the errors of the listing's form are 0.146 and 0.242.
//
// What differs, and why:
// - l is in radii, where the source has 0.1 scene units: the result then does not depend on the
//   unit of the scene. At R = 1 it is the same number.
// - What the precision of P demands is taken from n.v, so that rounding does not hide.
// - t is taken for each tap, since whole pixels lie beside the direction: a plane does not hide
//   itself. The angles are those at the view ray, where the paper takes the picture's axis.
// - What is outside the frame or background hides nothing.
// - The pattern is stratified, and its angles cover the whole turn: the source does not show the
//   texture that it reads them from, and its directions are not evenly spread. Seeds shift it by
//   the sequence R2 of Roberts (2018).
// - The distance beyond which there is no effect is endless by default; the source names no value.
// - Pixels that are not square are taken into account. Normals from depth are made before.
//
// Known faults, kept: horizons know no cosine to the normal, and what enters the radius hides at
// once; the mean of taps is not a horizon, and a low wall hides like a high one that its taps do
// not reach; taps stop at 3/4 of the radius, and the cap on the disc makes shadows of near surfaces
// smaller, the more pixels the picture has.
#include "estimators/hbao.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "estimators/view_space/openness.h"
#include "estimators/view_space/point_kernel.h"
#include "estimators/view_space/tiled_noise.h"
#include "math/sequence_numbers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/hbao.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_HBAO_JOB_
#define SSDO_HBAO_JOB_
namespace ssdo {

struct HbaoJob {
  const ViewPlanes& planes;
  TiledNoise cosine, sine, jitter;
  int steps;
  float inverse_radius;
  float disc_px;     ///< vertical radius of the disc at depth 1, or at any where orthographic
  float largest_px;  ///< beyond which the disc does not grow
  float bias;        ///< a sine
  float least2;      ///< radii^2
  float scale;       ///< m / (4 S), or s / 4 of horizons
  bool horizons;     ///< the largest of each direction, in place of the mean of all taps
  float farthest_z;  ///< what is behind is left open
};

/// Directions of the listing, in the picture.
struct HbaoDirection {
  float x, y;
};
constexpr HbaoDirection kHbaoDirections[] = {
    {1, 0}, {-0.5f, 0.8660254f}, {-0.5f, -0.8660254f}, {0, 1}};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The listing's saturate(n.v / |v| - b) saturate(1 - v.v), v in radii; 0 for what is not finite.
HWY_INLINE V hbao_occlusion(const HbaoJob& job, const V3& v, const V3& normal, V rounding) {
  const V distance2 = dot(v, v), held2 = hn::Max(distance2, set(job.least2));
  const V sine = (dot(v, normal) - rounding) / hn::Sqrt(held2);
  const V term = saturate(sine - set(job.bias)) * saturate(set(1) - held2);
  return hn::IfThenElseZero(distance2 < set(1), term);
}

/// The text's max(0, sin h - sin(t + asin b)) of a tap, v in radii; 0 for what is not finite.
HWY_INLINE V hbao_rise(const HbaoJob& job, const V3& v, const ViewReceiver& p, const V3& to_viewer,
                       V rounding) {
  constexpr float kEdgeOn = 1e-3f;  // planes nearer to edge-on have the tangents of this cosine
  const V distance2 = dot(v, v), above = dot(v, p.normal) - rounding;
  const M counts = hn::And(above > set(0), distance2 < set(1));
  if (!any(counts)) return set(0);
  const V facing = hn::Max(dot(p.normal, to_viewer), set(kEdgeOn));
  const V3 tangent = v - to_viewer * (above / facing);
  const V along = dot(tangent, to_viewer), length2 = hn::Max(dot(tangent, tangent), set(1e-30f));
  const V sin_t = along / hn::Sqrt(length2);
  const V cos_t = hn::Sqrt(hn::Max(hn::NegMulAdd(sin_t, sin_t, set(1)), set(0)));
  const V sin_b = set(job.bias), cos_b = hn::Sqrt(set(1) - sin_b * sin_b);
  const M below_zenith = cos_t * cos_b > sin_t * sin_b;
  const V least = hn::IfThenElse(below_zenith, sin_t * cos_b + cos_t * sin_b, set(1));
  const V sin_h = dot(v, to_viewer) / hn::Sqrt(hn::Max(distance2, set(1e-30f)));
  return hn::IfThenElseZero(counts, hn::Max(sin_h - least, set(0)));
}

void hbao_of_tile(const HbaoJob& job, const Tile& tile, Plane<float>& ao) {
  const ViewPlanes& planes = job.planes;
  set_openness(planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const V disc = length_px(planes, p, job.disc_px);
    const V step = hn::Min(disc, set(job.largest_px)) * set(1 / float(job.steps + 1));
    const V cosine = load(job.cosine.at(planes, x, y)), sine = load(job.sine.at(planes, x, y));
    const V first = hn::MulAdd(load(job.jitter.at(planes, x, y)), step, set(1));
    const V stretch = set(planes.fx / planes.fy);
    const V rounding = p.rounding * set(job.inverse_radius);
    const V3 to_viewer = direction_to_viewer(planes, p);
    V sum = set(0);
    for (const HbaoDirection& w : kHbaoDirections) {
      const V across = (set(w.x) * cosine - set(w.y) * sine) * stretch,
              down = set(w.x) * sine + set(w.y) * cosine;
      V highest = set(0);
      for (int s = 0; s < job.steps; ++s) {
        const V distance = hn::MulAdd(set(float(s)), step, first);
        const V dx = hn::Round(across * distance), dy = hn::Round(down * distance);
        const V z = gather_depth(planes, pixels_at(planes, p.x + dx, p.y + dy));
        const V3 v = way_to(planes, p, dx, dy, z);
        const V3 scaled = v * set(job.inverse_radius);
        if (job.horizons)
          highest = hn::Max(highest, hbao_rise(job, scaled, p, to_viewer, rounding));
        else
          sum = sum + hbao_occlusion(job, scaled, p.normal, rounding);
      }
      sum = sum + highest;
    }
    const V open = hn::NegMulAdd(sum, set(job.scale), set(1));
    return hn::IfThenElse(p.position.z >= set(job.farthest_z), open, set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(hbao_of_tile);

namespace {

/// One random number of every sixteenth of 0..1, in random order.
std::array<float, 16> shuffled_strata(RandomNumbers& random) {
  std::array<float, 16> values;
  for (std::size_t i = 0; i < 16; ++i) values[i] = (float(i) + random()) / 16;
  for (std::size_t i = 15; i > 0; --i)
    std::swap(values[i], values[std::min(i, std::size_t(random() * float(i + 1)))]);
  return values;
}

template <class Function>
TiledNoise noise_of(const std::array<float, 16>& turns, const Function& function) {
  std::array<float, 16> values;
  for (std::size_t i = 0; i < 16; ++i)
    values[i] = float(function(2 * std::numbers::pi * double(turns[i])));
  return TiledNoise(values);
}

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  const auto parameter = [&](const char* name) { return request.parameters.find(name)->second; };
  const int steps = int(parameter("steps"));
  const double bias = parameter("bias"), least = parameter("least-distance"),
               farthest = parameter("max-distance");
  const bool horizons = parameter("horizon") != 0;
  const double gain = horizons ? 1 : 2 / ((1 - bias) * steps);
  const ViewPlanes planes = make_view_planes(scene.geometry);
  const HbaoPattern pattern = hbao_pattern(request.seed);
  const HbaoJob job{planes,
                    noise_of(pattern.turn, [](double a) { return std::cos(a); }),
                    noise_of(pattern.turn, [](double a) { return std::sin(a); }),
                    TiledNoise(pattern.jitter),
                    steps,
                    1 / request.radius,
                    planes.fy * request.radius,
                    float(parameter("max-pixels")),
                    float(bias),
                    float(least * least),
                    float(gain * parameter("strength") / 4),
                    horizons,
                    farthest > 0 ? float(-farthest) : std::numeric_limits<float>::lowest()};
  const auto find = [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(hbao_of_tile)(job, tile, ao);
  };
  return products_of_ao(scene, request, find_openness(planes, progress, find));
}

}  // namespace

HbaoPattern hbao_pattern(unsigned seed) {
  RandomNumbers random(0);
  HbaoPattern pattern{shuffled_strata(random), shuffled_strata(random)};
  for (float& turn : pattern.turn) turn = float(fraction(turn + seed * kR2First));
  for (float& jitter : pattern.jitter) jitter = float(fraction(jitter + seed * kR2Second));
  return pattern;
}

Method hbao_method() {
  const auto taps = [](int steps) {
    return Rung{{{"steps", steps}}, fmt::format("4 x {} taps", steps)};
  };
  return {
      .name = "hbao",
      .summary = "horizon-based ambient occlusion, four directions of taps in the picture",
      .products = {.ao = true, .direct = true},
      .supports = {.radius = true},
      .pattern_size = TiledNoise::kSize,
      .published_filter = {"normal"},
      .parameters =
          {
              {"steps", 3, 1, 256, "", "taps in each of the four directions", true},
              {"horizon", 1, 0, 1, "", "of a direction: the mean of its taps, or the highest one",
               true, "taps max"},
              {"bias", 0.05, 0, 0.99, "", "sine above the tangent plane below which nothing hides"},
              {"strength", 1, 0, 10, "", "how much an occluder takes away"},
              {"least-distance", 0.1, 1e-6, 1, "radii", "nearer surfaces count as this far away"},
              {"max-pixels", 128, 1, 1e6, "pixels", "to which the radius in the picture is cut"},
              {"max-distance", 0, 0, 1e30, "units", "deeper surfaces are left open; 0: none"},
          },
      .samples_per_pixel = [](const Request& r) { return 4 * int(r.parameters.at("steps")); },
      .estimate = estimate,
      .ladder = {.rungs = {taps(2), taps(3), taps(6), taps(12), taps(24)},
                 .limit = taps(32),
                 .seeds = 64},
  };
}

}  // namespace ssdo
#endif
