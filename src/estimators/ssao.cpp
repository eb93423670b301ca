// SPDX-License-Identifier: Apache-2.0
//
// Screen-space ambient occlusion with points in the normal's half-ball: Mittring, "Finding Next
// Gen", SIGGRAPH 2007 courses, in the form of Chapman, "SSAO Tutorial" (2013), that de Vries'
// LearnOpenGL spread.
//
//   ao(p) = 1 - 1/N sum_i [z(q_i) >= z(x_i) + bias] smoothstep(0, 1, R / |z(p) - z(q_i)|)
//   x_i = p + R F(p) s_i
//
// s_i are points of the half-ball that crowd around p; F turns it about the normal n to a random
// vector of a 4 x 4 pattern, by Gram-Schmidt. q_i is the surface in the pixel that x_i projects to;
// z is negative in front of the viewer. The smoothstep is the range check: what lies far in front
// of p, or far behind it, does not count.
//
// What differs, and why:
// - The bias is a share of the radius, 0.025 for R = 0.5 as in one source (another has none: set
//   bias=0), so that it knows no unit, plus what the precision of P demands.
// - Outside the frame there is nothing that occludes; the sources repeat the frame there.
//
// Known faults, kept: a point is tested, not the ray to it, and all points weigh the same whatever
// their cosine, so that the result is no visibility even when converged. The depth in a pixel's
// centre stands for all of the pixel: a plane seen at a grazing angle hides itself in part.
#include "estimators/ssao.h"

#include "estimators/view_space/openness.h"
#include "estimators/view_space/point_kernel.h"
#include "estimators/view_space/tiled_noise.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/ssao.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"

#ifndef SSDO_SSAO_JOB
#define SSDO_SSAO_JOB
namespace ssdo {
namespace {

struct SsaoJob {
  const ViewPlanes& planes;
  std::vector<glm::vec3> points;  ///< R s_i
  TiledNoise noise_x, noise_y;
  float radius, bias;  ///< scene units
};

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What occludes as the range check weighs it, for surfaces at the distance `range` from p along
/// the axis.
HWY_INLINE V range_check(V range, V radius) {
  if (all(range <= radius)) return set(1);
  return smooth(radius / hn::Max(range, radius));
}

void ssao_of_tile(const SsaoJob& job, const Tile& tile, Plane<float>& ao) {
  const ViewPlanes& planes = job.planes;
  const V radius = set(job.radius), share = set(1 / float(job.points.size()));
  set_openness(planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const TangentFrame frame = tangent_frame(planes, job.noise_x, job.noise_y, x, y, p.normal);
    const V bias = p.rounding + set(job.bias);
    V occlusion = set(0);
    for (const glm::vec3& s : job.points) {
      const V3 point = frame.place(set(s), p.position);
      const V z = gather_depth(planes, project(planes, point));
      const M hidden = z >= point.z + bias;
      const V range = hn::IfThenElseZero(hidden, hn::Abs(p.position.z - z));
      occlusion = occlusion + hn::IfThenElseZero(hidden, range_check(range, radius));
    }
    return hn::NegMulAdd(occlusion, share, set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {
namespace {

HWY_EXPORT(ssao_of_tile);

Products estimate_ssao(const Scene& scene, const Request& request, const Progress& progress) {
  const ViewPlanes planes = make_view_planes(scene.geometry);
  std::vector<glm::vec3> points =
      point_kernel(int(request.parameters.at("samples")), 0.1f, true, request.seed);
  for (glm::vec3& s : points) s *= request.radius;
  const auto noise = frame_noise(request.seed);
  const SsaoJob job{planes,
                    std::move(points),
                    TiledNoise(coordinate(noise, 0)),
                    TiledNoise(coordinate(noise, 1)),
                    request.radius,
                    float(request.parameters.at("bias")) * request.radius};
  const auto find = [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(ssao_of_tile)(job, tile, ao);
  };
  return products_of_ao(scene, request, find_openness(planes, progress, find));
}

}  // namespace

Method ssao_method() {
  return {
      .name = "ssao",
      .summary = "points in the normal's half-ball with a range check, Chapman 2013",
      .products = {.ao = true, .direct = true},
      .supports = {.radius = true},
      .pattern_size = TiledNoise::kSize,
      .published_filter = {"box"},
      .parameters =
          {
              {"samples", 64, 1, 1024, "", "points per pixel", true},
              {"bias", 0.05, 0, 1, "radii", "how far in front of a point a surface has to be"},
          },
      .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
      .estimate = estimate_ssao,
      .ladder = {.rungs = rungs_of("samples", {16, 32, 64, 128}),
                 .limit = {{{"samples", 512}}},
                 .seeds = 8},
  };
}

}  // namespace ssdo
#endif
