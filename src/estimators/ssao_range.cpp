// SPDX-License-Identifier: Apache-2.0
//
// Ambient occlusion with points in the normal's half-ball that are tested against the depth of the
// pixel itself, as a series of lessons on Unity builds it, with its range check, its self-check
// and its weight. The half-ball is that of Chapman, "SSAO Tutorial" (2013).
//
//   ao(p) = max(0, 1 - strength/N sum_i w_i [d(q_i) + bias < d(p)] [|d(q_i) - d(p)| <= range])
//   w_i = smoothstep(0, 0.2, |xy of v_i|)    v_i = F(p) s_i    x_i = p + R v_i
//
// s_i are points of the half-ball with lengths from 0.01 to 1, growing with the square of i / N; F
// turns it about the normal to a random vector of a 4 x 4 pattern, by Gram-Schmidt. q_i is the
// surface in the pixel that x_i projects to and d its depth. w reduces the weight of points that
// project close to p, in units of the half-ball.
//
// What differs, and why:
// - range and bias are in radii. The source has them as shares of the far plane's depth, which is
//   not known of a frame, and names no values. What the precision of P demands adds to the bias.
// - The pattern's vectors lie in the picture's plane, as in method ssao: the source does not show
//   the texture that it reads them from.
// - Outside the frame there is nothing that occludes.
//
// Known fault, kept: the surface is compared with the depth of p, not of x_i. Whatever lies nearer
// to the viewer than p occludes, in front of x_i or behind it: a plane that does not face the
// viewer hides itself in part.
#include "estimators/ssao_range.h"

#include "estimators/view_space/openness.h"
#include "estimators/view_space/point_kernel.h"
#include "estimators/view_space/tiled_noise.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/ssao_range.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_SSAO_RANGE_JOB
#define SSDO_SSAO_RANGE_JOB
namespace ssdo {
namespace {

struct RangeJob {
  const ViewPlanes& planes;
  std::vector<glm::vec3> points;  ///< s_i
  TiledNoise noise_x, noise_y;
  float radius, range, bias;  ///< scene units
  float strength;
};

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void ssao_range_of_tile(const RangeJob& job, const Tile& tile, Plane<float>& ao) {
  const ViewPlanes& planes = job.planes;
  const V radius = set(job.radius), farthest = set(job.range);
  const V share = set(job.strength / float(job.points.size()));
  set_openness(planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const TangentFrame frame = tangent_frame(planes, job.noise_x, job.noise_y, x, y, p.normal);
    const V bias = p.rounding + set(job.bias);
    V occlusion = set(0);
    for (const glm::vec3& s : job.points) {
      const V3 v = frame.place(set(s), set(glm::vec3(0)));
      const V z = gather_depth(planes, project(planes, mul_add(v, radius, p.position)));
      const V nearer = z - p.position.z;
      const M hidden = hn::And(nearer > bias, nearer <= farthest);
      if (!any(hidden)) continue;
      const V across = hn::Sqrt(dot(V2{v.x, v.y}, V2{v.x, v.y}));
      const V weight = smoothstep(set(0), set(0.2f), across);
      occlusion = occlusion + hn::IfThenElseZero(hidden, weight);
    }
    return hn::NegMulAdd(occlusion, share, set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {
namespace {

HWY_EXPORT(ssao_range_of_tile);

Products estimate_ssao_range(const Scene& scene, const Request& request, const Progress& progress) {
  const ViewPlanes planes = make_view_planes(scene.geometry);
  const auto noise = frame_noise(request.seed);
  const RangeJob job{
      planes,
      point_kernel(int(request.parameters.at("samples")), 0.01f, false, request.seed),
      TiledNoise(coordinate(noise, 0)),
      TiledNoise(coordinate(noise, 1)),
      request.radius,
      float(request.parameters.at("range")) * request.radius,
      float(request.parameters.at("bias")) * request.radius,
      float(request.parameters.at("strength"))};
  const auto find = [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(ssao_range_of_tile)(job, tile, ao);
  };
  return products_of_ao(scene, request, find_openness(planes, progress, find));
}

}  // namespace

Method ssao_range_method() {
  return {
      .name = "ssao-range",
      .summary = "points in the normal's half-ball against the pixel's own depth, hard range check",
      .products = {.ao = true, .direct = true},
      .supports = {.radius = true},
      .pattern_size = TiledNoise::kSize,
      .published_filter = {"normal"},
      .parameters =
          {
              {"samples", 64, 1, 1024, "", "points per pixel", true},
              {"range", 1, 0, 1000, "radii",
               "surfaces nearer to the viewer by more do not occlude"},
              {"bias", 0.05, 0, 100, "radii",
               "surfaces nearer to the viewer by less do not occlude"},
              {"strength", 1, 0, 10, "", "how much an occluder takes away"},
          },
      .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
      .estimate = estimate_ssao_range,
      .ladder = {.rungs = rungs_of("samples", {16, 32, 64, 128}),
                 .limit = {{{"samples", 512}}},
                 .seeds = 8},
  };
}

}  // namespace ssdo
#endif
