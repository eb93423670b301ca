// SPDX-License-Identifier: Apache-2.0
//
// Horizon-based ambient occlusion: Bavoil, Sainz, Dimitrov, SIGGRAPH 2008, in the later form that
// takes the mean over all taps instead of the highest of each direction, as a Unity shader of a
// series of lessons has it:
//
//   ao(p) = max(0, 1 - m / (4 S) sum_d sum_s saturate(n.v / |v| - b) saturate(1 - v.v / R^2))
//
// v leads from p to the surface in the pixel of a tap, v.v is at least l^2, b is the sine of the
// angle above the tangent plane from which on a surface hides. Tap s = 0..S-1 of direction d is
// round(w (1 + (j + s) step)) pixels away, w at 0, 120, 240 and 90 degrees plus the angle of the
// pixel, step = min(disc, cap) / (S + 1), disc the radius R in pixels at p. The angle and j repeat
// every 4 x 4 pixels. m = 2 s / (1 - b) with the strength s, as in published code of this form.
//
// disc is the whole radius, as in the paper and the authors' code of 2008. Their later code, which
// this form comes from, takes half of it; the series' own script takes half of it times the
// picture's width over its height, by mistake, 0.89 at 16:9. It makes little difference: the error
// of ao on the seven frames of man ssdo-methods is 0.148 and 0.247 at the small and the large
// radius with the whole, 0.146 and 0.242 with half of it.
//
// What differs, and why:
// - l is in radii, where the source has 0.1 scene units: the result then does not depend on the
//   unit of the scene. At R = 1 it is the same number.
// - What the precision of P demands is taken from n.v, so that rounding does not hide.
// - What is outside the frame or background hides nothing.
// - The pattern is stratified, and its angles cover the whole turn: the source does not show the
//   texture that it reads them from, and its directions are not evenly spread.
// - The distance beyond which there is no effect is endless by default; the source names no value.
// - Pixels that are not square are seen as they are. Normals from depth are made before.
//
// Known faults, kept: the mean of taps is not a horizon, and a low wall hides like a high one that
// its taps do not reach; taps stop at 3/4 of the radius, and the cap on the disc makes shadows of
// near surfaces smaller, the more pixels the picture has.
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
  float scale;       ///< m / (4 S)
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

/// saturate(n.v / |v| - b) saturate(1 - v.v), v in radii; 0 for what is not finite.
HWY_INLINE V hbao_occlusion(const HbaoJob& job, const V3& v, const V3& normal, V rounding) {
  const V distance2 = dot(v, v), held2 = hn::Max(distance2, set(job.least2));
  const V sine = (dot(v, normal) - rounding) / hn::Sqrt(held2);
  const V term = saturate(sine - set(job.bias)) * saturate(set(1) - held2);
  return hn::IfThenElseZero(distance2 < set(1), term);
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
    V sum = set(0);
    for (const HbaoDirection& w : kHbaoDirections) {
      const V across = (set(w.x) * cosine - set(w.y) * sine) * stretch,
              down = set(w.x) * sine + set(w.y) * cosine;
      for (int s = 0; s < job.steps; ++s) {
        const V distance = hn::MulAdd(set(float(s)), step, first);
        const V dx = hn::Round(across * distance), dy = hn::Round(down * distance);
        const V z = gather_depth(planes, pixels_at(planes, p.x + dx, p.y + dy));
        const V3 v = way_to(planes, p, dx, dy, z);
        sum = sum + hbao_occlusion(job, v * set(job.inverse_radius), p.normal, rounding);
      }
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
                    float(2 * parameter("strength") / ((1 - bias) * 4 * steps)),
                    farthest > 0 ? float(-farthest) : std::numeric_limits<float>::lowest()};
  const auto find = [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(hbao_of_tile)(job, tile, ao);
  };
  return products_of_ao(scene, request, find_openness(planes, progress, find));
}

}  // namespace

HbaoPattern hbao_pattern(unsigned seed) {
  RandomNumbers random(seed);
  HbaoPattern pattern;
  pattern.turn = shuffled_strata(random);
  pattern.jitter = shuffled_strata(random);
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
      .takes = {.radius = true},
      .pattern_size = TiledNoise::kSize,
      .parameters =
          {
              {"steps", 3, 1, 256, "", "taps in each of the four directions", true},
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
