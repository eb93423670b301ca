// SPDX-License-Identifier: Apache-2.0
//
// Ambient occlusion by potential occluders with a linear fade: Luna, "Introduction to 3D Game
// Programming with DirectX 12" (2016), chapter 21.
//
//   access(p) = 1 - 1/14 sum_i max(0, n . (r_i - p) / |r_i - p|) fade(z(r_i) - z(p))
//   ao = access^power        fade(d) = saturate((end - d) / (end - start)), 0 where d <= epsilon
//   q_i = p + R sgn(n . o_i) o_i        o_i = reflect(v_i, m) = v_i - 2 (v_i . m) m
//
// v_i point to the corners and faces of a cube, m is a random vector of a 4 x 4 pattern. r_i, the
// potential occluder, is the point of the ray from the viewer through q_i at the depth of the
// surface that is seen there; z is negative in front of the viewer. ao is evaluated at half width
// and half height and upsampled bilinearly, or along surfaces, or evaluated at every pixel. The
// source blurs what it has at half resolution before it goes up: Request::filter_half.
//
// With distance to the viewer the effect can be taken back, from all of it at distance-start to
// none at distance-end: the source's advice where depth is too coarse for wide scenes.
//
// What differs, and why:
// - Depths are read at the nearest pixel: a bilinear one lies, at an edge, on neither surface.
// - Fades and epsilon are in radii (the published code has 0.2, 1 and 0.05 for R = 0.5); what the
//   precision of P demands adds to epsilon.
// - The pattern of m is 4 x 4 evaluated pixels, where the source tiles a map of random vectors four
//   times over the frame: noise of the same kind, with a period that a filter can remove.
//
// Known faults, kept: m is not a unit vector, so that points lie up to five radii away from p. The
// power has no meaning in light; it darkens what is half open. Bilinear upsampling carries light
// over edges.
#include "estimators/ssao_fade.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>

#include "estimators/view_space/half_resolution.h"
#include "estimators/view_space/openness.h"
#include "estimators/view_space/point_kernel.h"
#include "estimators/view_space/tiled_noise.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/ssao_fade.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_SSAO_FADE_JOB
#define SSDO_SSAO_FADE_JOB
namespace ssdo {
namespace {

struct FadeJob {
  const ViewPlanes &receivers, &planes;
  std::array<glm::vec3, 14> offsets;
  TiledNoise noise_x, noise_y, noise_z;
  float radius, epsilon, fade_start, fade_end;  ///< scene units
};

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The point at depth z on the viewer's ray through q.
HWY_INLINE V3 at_depth(const ViewPlanes& planes, const V3& q, V z) {
  if (planes.orthographic) return {q.x, q.y, z};
  return q * (set(-1) / q.z * hn::Neg(z));
}

void access_of_tile(const FadeJob& job, const Tile& tile, Plane<float>& access) {
  const ViewPlanes& planes = job.planes;
  const V radius = set(job.radius), end = set(job.fade_end);
  const V per_length = set(1 / std::max(job.fade_end - job.fade_start, 1e-20f));
  set_openness(job.receivers, tile, access, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const V3 m = {load(job.noise_x.at(job.receivers, x, y)),
                  load(job.noise_y.at(job.receivers, x, y)),
                  load(job.noise_z.at(job.receivers, x, y))};
    const V epsilon = p.rounding + set(job.epsilon);
    V occlusion = set(0);
    for (const glm::vec3& v : job.offsets) {
      const V3 offset = set(v);
      const V3 o = mul_add(m, set(-2) * dot(offset, m), offset);
      const V3 q = mul_add(o, hn::CopySign(radius, dot(o, p.normal)), p.position);
      const V z = gather_depth(planes, project(planes, q));
      const V nearer = z - p.position.z;
      const M counts = nearer > epsilon;
      const V3 to_r = at_depth(planes, q, z) - p.position;
      const V facing = hn::Max(dot(to_r, p.normal), set(0)) / hn::Sqrt(dot(to_r, to_r));
      const V fade = saturate((end - nearer) * per_length);
      occlusion = occlusion + hn::IfThenElseZero(counts, facing * fade);
    }
    return hn::NegMulAdd(occlusion, set(1.0f / 14), set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(access_of_tile);

std::array<glm::vec3, 14> fade_offsets(unsigned seed) {
  constexpr int kAxes[14][3] = {{1, 1, 1},   {-1, -1, -1}, {-1, 1, 1}, {1, -1, -1}, {1, 1, -1},
                                {-1, -1, 1}, {-1, 1, -1},  {1, -1, 1}, {-1, 0, 0},  {1, 0, 0},
                                {0, -1, 0},  {0, 1, 0},    {0, 0, -1}, {0, 0, 1}};
  RandomNumbers random(seed);
  std::array<glm::vec3, 14> offsets;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const glm::vec3 axis(kAxes[i][0], kAxes[i][1], kAxes[i][2]);
    offsets[i] = random.between(0.25f, 1) * glm::normalize(axis);
  }
  return offsets;
}

std::array<glm::vec3, 16> fade_noise(unsigned seed) {
  RandomNumbers random(~seed);
  std::array<glm::vec3, 16> noise;
  for (glm::vec3& m : noise) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    m = {x, y, z};
  }
  return noise;
}

namespace {

enum Upsampling { kNone, kBilinear, kAlongSurfaces };

/// Raises access to the power and takes the effect back with distance.
void shape(const ParameterValues& parameters, const ViewPlanes& planes, Plane<float>& access) {
  const float power = float(parameters.at("power"));
  const float start = float(parameters.at("distance-start")),
              end = float(parameters.at("distance-end"));
  for_each_row(access.height, [&](int y) {
    const float* z = planes.z.row(y);
    for (int x = 0; x < access.width; ++x) {
      float& ao = access(x, y);
      ao = power == 2 ? ao * ao : std::pow(ao, power);
      if (end <= 0 || !shows_surface(z[x])) continue;
      const float left = (end + z[x]) / std::max(end - start, 1e-20f);
      ao = 1 - std::clamp(left, 0.0f, 1.0f) * (1 - ao);
    }
  });
}

Products estimate_ssao_fade(const Scene& scene, const Request& request, const Progress& progress) {
  const auto value = [&](const char* name) { return float(request.parameters.at(name)); };
  const int upsampling = int(request.parameters.at("upsampling"));
  const ViewPlanes planes = make_view_planes(scene.geometry);
  std::optional<HalfResolution> half;
  if (upsampling != kNone) half.emplace(planes);
  const ViewPlanes& receivers = half ? half->receivers() : planes;
  const auto noise = fade_noise(request.seed);
  const FadeJob job{receivers,
                    planes,
                    fade_offsets(request.seed),
                    TiledNoise(coordinate(noise, 0)),
                    TiledNoise(coordinate(noise, 1)),
                    TiledNoise(coordinate(noise, 2)),
                    request.radius,
                    value("epsilon") * request.radius,
                    value("fade-start") * request.radius,
                    value("fade-end") * request.radius};
  const auto find = [&](const Tile& tile, Plane<float>& access) {
    HWY_DYNAMIC_DISPATCH(access_of_tile)(job, tile, access);
  };
  Plane<float> access = find_openness(receivers, progress, find);
  shape(request.parameters, receivers, access);
  if (half && request.filter_half) access = request.filter_half(std::move(access), half->surfels());
  return products_of_ao(scene, request,
                        !half                     ? std::move(access)
                        : upsampling == kBilinear ? half->upsample_bilinear(access)
                                                  : half->upsample_along_surfaces(access));
}

}  // namespace

Method ssao_fade_method() {
  const Rung every_pixel{{{"upsampling", kNone}}, "every pixel"},
      bilinear{{{"upsampling", 1}}, "half, bilinear"},
      along_surfaces{{{"upsampling", 2}}, "half, along surfaces"};
  return {
      .name = "ssao-fade",
      .summary = "14 potential occluders with a linear fade at half resolution, Luna 2016",
      .products = {.ao = true, .direct = true},
      .supports = {.radius = true},
      .pattern_size = 2 * TiledNoise::kSize,
      .published_filter = {"gaussian",
                           [](const ParameterValues& p) {
                             return int(p.at("upsampling")) != kNone;
                           }},
      .parameters =
          {
              {"epsilon", 0.1, 0, 100, "radii",
               "what is nearer to the viewer by less does not occlude"},
              {"fade-start", 0.4, 0, 1000, "radii", "where occluders begin to lose weight"},
              {"fade-end", 2, 0, 1000, "radii", "where they have none left"},
              {"power", 2, 0, 64, "", "contrast"},
              {"upsampling", 1, 0, 2, "",
               "0: at every pixel; at half resolution, 1: bilinear, 2: along surfaces", true},
              {"distance-start", 0, 0, 1e12, "scene units", "where the effect begins to fade"},
              {"distance-end", 0, 0, 1e12, "scene units", "where it is gone; 0: nowhere"},
          },
      // At half resolution 3.5 for each pixel of the frame.
      .samples_per_pixel =
          [](const Request& r) { return int(r.parameters.at("upsampling")) == kNone ? 14 : 4; },
      .estimate = estimate_ssao_fade,
      .ladder = {.rungs = {bilinear, along_surfaces, every_pixel},
                 .limit = every_pixel,
                 .seeds = 128},
  };
}

}  // namespace ssdo
#endif
