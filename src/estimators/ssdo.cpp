// SPDX-License-Identifier: Apache-2.0
//
// Screen-space directional occlusion: Ritschel, Grosch, Seidel, "Approximating Dynamic Global
// Illumination in Image Space", I3D 2009, in the form of their chapter in GPU Pro (2010).
//
//   direct(p) = 1/pi * 2 pi/N * sum_i V_i L(w_i) (n.w_i)        over N points x_i = p + R l_i w_i,
//   bounce(p) = 1/pi * 2 pi/N * sum_i L_s(q_i) min(F_i, F_max)  uniform in the half-ball about n
//
// q_i is the surface in the pixel that x_i projects to. V_i is 0 where that surface is in front of
// x_i, nearer than the singularity. F_i = R^2 cos_p cos_q / d^2 is the form factor of q_i; every
// sample sends, hidden or not, as in the listing.
//
// What differs, and why:
// - "In front" is tested against the tangent plane of q, not the depth at its pixel's centre: on a
//   tilted plane the depth differs within a pixel by more than any bias would forgive.
// - The bias is a share of the radius plus what the precision of P demands, not a constant.
// - F has the factor R^2, the area that the samples stand for: the bounce and its clamp then do not
//   depend on the unit of the scene.
// - The environment is averaged over the solid angle of a sample, 2 pi / N, and looked up in an
//   octahedral map: the listing's "blurred map" without its pole.
// - direct is the ratio of the sum over visible samples to the sum over all, times the exact
//   irradiance on n without occluders. What N directions make of a sun differs from pixel to pixel
//   of the pattern, and on curved surfaces no filter averages it away; in the ratio it cancels.
//
// Known fault, kept: a point is tested, not the ray to it. What lies between p and x_i is missed
// and what hides x_i from the eye alone counts, so that the result is biased even when converged.
#include "estimators/ssdo.h"

#include <array>
#include <glm/gtc/constants.hpp>
#include <optional>

#include "estimators/view_space/half_ball.h"
#include "estimators/view_space/openness.h"
#include "estimators/view_space/tiled_noise.h"
#include "math/light_range.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/ssdo.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"
#include "scene/light/light-inl.h"

#ifndef SSDO_SSDO_JOB
#define SSDO_SSDO_JOB
namespace ssdo {
namespace {

/// One point of the half-ball about the normal, in each pixel of the pattern.
struct PatternPoint {
  TiledNoise x, y, cosine;  ///< of the unit direction to it
  TiledNoise length;        ///< R l
};

/// Both passes see the same points and the same surfaces.
struct SsdoJob {
  const ViewPlanes& planes;
  std::vector<PatternPoint> points;

  // Direct light; lengths in scene units.
  float bias, singularity, strength;
  const Light& light;
  /// The environment in camera space, averaged over the solid angle of a sample; none: the same
  /// from everywhere.
  std::optional<OctahedralMap> radiance;

  // Bounce light.
  float radius, gain;        ///< what the sum is multiplied by
  float bounce_singularity;  ///< F_max
};

}  // namespace
}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What receivers find at one of their points.
struct SsdoSample {
  V3 direction, to_point;  ///< from the receiver; the direction is unit
  V cosine;
  Pixels at;  ///< the pixel that shows the point
  V3 to_q;    ///< the surface there, from the receiver; not finite where there is none
};

HWY_INLINE SsdoSample sample_at(const SsdoJob& job, const PatternPoint& point,
                                const ViewReceiver& p, const TangentFrame& frame, int x, int y) {
  const ViewPlanes& planes = job.planes;
  SsdoSample s;
  s.cosine = load(point.cosine.at(planes, x, y));
  const V3 in_frame{load(point.x.at(planes, x, y)), load(point.y.at(planes, x, y)), s.cosine};
  s.direction = frame.place(in_frame, set(glm::vec3(0)));
  s.to_point = s.direction * load(point.length.at(planes, x, y));
  s.at = project(planes, p.position + s.to_point);
  const V right = hn::ConvertTo(D(), s.at.column) - p.x, down = hn::ConvertTo(D(), s.at.row) - p.y;
  s.to_q = way_to(planes, p, right, down, gather_depth(planes, s.at));
  return s;
}

/// Where the surface is in front of the point by more than the bias and nearer to it than the
/// singularity. The background is in front of nothing.
HWY_INLINE M is_hidden(const SsdoJob& job, const SsdoSample& s, V bias) {
  const V3 from_q = s.to_point - s.to_q;
  const M near = hn::Abs(from_q.z) < set(job.singularity);
  if (!any(near)) return near;
  return hn::And(near, dot(from_q, gather_normal(job.planes, s.at)) < hn::Neg(bias));
}

/// part / whole; 0 where `whole` is 0.
HWY_INLINE V share_of(V part, V whole) {
  return hn::IfThenElseZero(whole > set(0), hn::Max(part, set(0)) / whole);
}

/// Visibility of every sample against the environment. `direct` may be empty.
void direct_of_tile(const SsdoJob& job, const Tile& tile, Plane<float>& ao,
                    Plane<glm::vec3>& direct) {
  const V hidden_share = set(1 - job.strength);
  set_openness(job.planes, tile, ao, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const TangentFrame frame = frame_about(p.normal);
    const V bias = p.rounding + set(job.bias);
    V visible = set(0);
    V3 lit = set(glm::vec3(0)), light = lit;
    for (const PatternPoint& point : job.points) {
      const SsdoSample s = sample_at(job, point, p, frame, x, y);
      const V share = hn::IfThenElse(is_hidden(job, s, bias), hidden_share, set(1));
      visible = hn::MulAdd(share, s.cosine, visible);
      if (!job.radiance || direct.empty()) continue;
      const V3 arriving = look_up(*job.radiance, s.direction) * s.cosine;
      light = light + arriving;
      lit = mul_add(arriving, share, lit);
    }
    // 2 pi / N over pi; clamped, since with a strength above 1 the sum may be negative.
    const V open = saturate(visible * set(2 / float(job.points.size())));
    if (direct.empty()) return open;
    const V3 share = job.radiance ? V3{share_of(lit.x, light.x), share_of(lit.y, light.y),
                                       share_of(lit.z, light.z)}
                                  : V3{open, open, open};
    const V3 arriving = unoccluded(job.light, p.position, p.normal) * share;
    store_first(tile.x1 - x, if_then_else_zero(p.valid, arriving), &direct(x, y));
    return open;
  });
}

/// Light that the surfaces around every pixel send on: `sent` is their radiance.
void bounce_of_tile(const SsdoJob& job, const Tile& tile, const Plane<glm::vec3>& sent,
                    Plane<glm::vec3>& bounce) {
  const ViewPlanes& planes = job.planes;
  for_each_vector(planes, tile, [&](int x, int y) HWY_ATTR {
    const ViewReceiver p = load_receiver(planes, x, y);
    const TangentFrame frame = frame_about(p.normal);
    V3 sum = set(glm::vec3(0));
    for (const PatternPoint& point : job.points) {
      const SsdoSample s = sample_at(job, point, p, frame, x, y);
      // The cosines still carry the length of to_q.
      const V cos_p = dot(s.to_q, p.normal);
      if (!any(cos_p > set(0))) continue;
      const V cos_q = hn::Neg(dot(s.to_q, gather_normal(planes, s.at)));
      const M faces = hn::And(cos_p > set(0), cos_q > set(0));
      if (!any(faces)) continue;
      const V d2 = hn::Max(dot(s.to_q, s.to_q), set(1e-20f));
      const V form_factor = set(job.radius * job.radius) * cos_p * cos_q / (d2 * d2);
      const M sends = hn::And(faces, form_factor > set(0));  // what is not finite has none
      const V weight = hn::IfThenElseZero(sends, hn::Min(form_factor, set(job.bounce_singularity)));
      const VI index = (s.at.row * set_int(sent.width) + s.at.column) * set_int(3);
      const float* red = &sent[0].x;
      sum = mul_add({gather(red, index), gather(red + 1, index), gather(red + 2, index)}, weight,
                    sum);
    }
    store_first(tile.x1 - x, sum * hn::IfThenElseZero(p.valid, set(job.gain)), &bounce(x, y));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(direct_of_tile);
HWY_EXPORT(bounce_of_tile);

namespace {

constexpr int kPatternSize = TiledNoise::kSize;

std::vector<PatternPoint> points_of(const Request& request, int count) {
  const auto sets = half_ball_pattern(kPatternSize, count, request.seed);
  std::vector<PatternPoint> points;
  for (std::size_t i = 0; i < std::size_t(count); ++i) {
    std::array<float, kPatternSize * kPatternSize> x, y, cosine, length;
    for (std::size_t k = 0; k < sets.size(); ++k) {
      const HalfBallSample& s = sets[k][i];
      x[k] = s.direction.x, y[k] = s.direction.y, cosine[k] = s.direction.z;
      length[k] = request.radius * s.length;
    }
    points.push_back({TiledNoise(x), TiledNoise(y), TiledNoise(cosine), TiledNoise(length)});
  }
  return points;
}

std::optional<OctahedralMap> radiance_of(const Scene& scene, int samples) {
  if (scene.light.is_constant()) return std::nullopt;
  return scene.light.environment.blurred(2 * glm::pi<float>() / float(samples),
                                         scene.geometry.world_to_camera);
}

/// The radiance that every pixel sends: its albedo times all the light that arrives, or that of the
/// layer of radiance.
Plane<glm::vec3> sender_radiance(const Scene& scene, const Products& so_far) {
  Plane<glm::vec3> sent(so_far.ao.width, so_far.ao.height);
  for_each_row(sent.height, [&](int y) {
    for (std::size_t i = sent.index(0, y); i < sent.index(0, y + 1); ++i) {
      sent[i] = within_range(scene.senders.radiance.empty()
                                 ? scene.senders.albedo[i] * (so_far.direct[i] + so_far.bounce[i])
                                 : scene.senders.radiance[i]);
    }
  });
  return sent;
}

Products estimate(const Scene& scene, const Request& request, const Progress& progress) {
  const auto parameter = [&](const char* name) { return float(request.parameters.at(name)); };
  const int samples = int(request.parameters.at("samples"));
  const ViewPlanes planes = make_view_planes(scene.geometry);
  const bool wants_light = request.products.direct || request.products.bounce;
  const SsdoJob job{planes,
                    points_of(request, samples),
                    parameter("bias") * request.radius,
                    parameter("singularity") * request.radius,
                    parameter("strength"),
                    scene.light,
                    wants_light ? radiance_of(scene, samples) : std::nullopt,
                    request.radius,
                    parameter("bounce-strength") * 2 / float(samples),
                    parameter("bounce-singularity")};
  const Plane<glm::vec3> black(planes.width(), planes.height(), glm::vec3(0));
  Products out;
  if (wants_light) out.direct = black;
  out.ao = find_openness(planes, progress, [&](const Tile& tile, Plane<float>& ao) {
    HWY_DYNAMIC_DISPATCH(direct_of_tile)(job, tile, ao, out.direct);
  });
  if (request.products.bounce) out.bounce = black;
  for (int pass = 0; request.products.bounce && pass < request.bounces; ++pass) {
    const Plane<glm::vec3> sent = sender_radiance(scene, out);
    const auto gather_light = [&](const Tile& tile) {
      HWY_DYNAMIC_DISPATCH(bounce_of_tile)(job, tile, sent, out.bounce);
    };
    for_each_tile(planes.width(), planes.height(), gather_light, progress);
  }
  return out;
}

}  // namespace

Method ssdo_method() {
  return {
      .name = "ssdo",
      .summary = "directional occlusion and one bounce, Ritschel et al. 2009",
      .products = {.ao = true, .direct = true, .bounce = true},
      .supports = {.radius = true},
      .pattern_size = kPatternSize,
      .published_filter = {"geometry"},
      .parameters =
          {
              {"samples", 16, 1, 1024, "", "points per pixel", true},
              {"bias", 0.001, 0, 1, "radii", "how far in front of a point a surface has to be"},
              {"singularity", 1, 0, 100, "radii",
               "surfaces farther in front than this do not occlude"},
              {"strength", 1, 0, 10, "", "how much an occluder takes away"},
              {"bounce-strength", 1, 0, 100, "", "gain of the bounce"},
              {"bounce-singularity", 1, 0, 1e6, "", "largest form factor of a sample"},
          },
      .samples_per_pixel = [](const Request& r) { return int(r.parameters.at("samples")); },
      .estimate = estimate,
      .ladder = {.rungs = rungs_of("samples", {8, 16, 32, 64, 128}),
                 .limit = {{{"samples", 512}}},
                 .seeds = 4},
  };
}

}  // namespace ssdo
#endif
