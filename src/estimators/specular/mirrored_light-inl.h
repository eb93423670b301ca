// SPDX-License-Identifier: Apache-2.0
//
// The unoccluded light that rough surfaces mirror, for vectors of surfaces, without noise:
//
//   sky     = R L(w_i) averaged by F(w_i) G1(w_i)    R: reflectance for even light, from a table
//   source  = E mean_k( weight_k F D' G1(v) G1(w_k) / (4 n.v) )
//
// w_i: directions that a few facets which the viewer sees mirror (Heitz 2018), the same for all
// pixels. L is a mean over the solid angle that each stands for, 1 / (count density): Krivanek and
// Colbert 2008, Real-time Shading with Filtered Importance Sampling. Light that is the same from
// everywhere is exact with any number of directions.
//
// w_k: points of the source. Each stands for a part of it, of the solid angle omega, which a mirror
// shows as a spot: D' has the distribution of the facets widened, along the plane of the viewer and
// across it, by
//
//   alpha_x'^2 = alpha^2 + 2 omega / (4 pi),  alpha_y'^2 = alpha^2 + 2 omega / (4 pi (h.l)^2)
//
// for facets turn by half of what mirrored light turns by, and aside by 1 / h.l more: a round spot
// is a streak of facets at a grazing view. Without the 2, a mirror shows each part with its own
// radiance: the density of what it mirrors, 1 / (pi alpha_x' alpha_y' 4 h.l), is 1 / omega. With
// random rays, to the source or to what facets mirror, small bright parts would be met by chance.
// Compiled once for every instruction set.
#if defined(SSDO_SPECULAR_MIRRORED_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SPECULAR_MIRRORED_LIGHT_INL_H_
#undef SSDO_SPECULAR_MIRRORED_LIGHT_INL_H_
#else
#define SSDO_SPECULAR_MIRRORED_LIGHT_INL_H_
#endif

#include <array>
#include <vector>

#include "estimators/specular/facets-inl.h"
#include "estimators/specular/mirror_map-inl.h"
#include "estimators/specular/mirror_model.h"
#include "math/sobol.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr int kSkyPoints = 32, kLeastSourcePoints = 8, kSourcePoints = 256;

/// Size of the spot of a point over its part of the source, above 1 so that spots blend. RMSE of a
/// mirrored square that is 40 degrees wide, roughness 0.2 and 64 points, relative to the RMS, with
/// 1, 2 and 4: 0.14, 0.13, 0.17, and its largest value over the true one 1.13, 1.05, 0.97.
constexpr float kOverlap = 2;

/// Reflectances::operator(), times the light that comes from everywhere alike: 1.
HWY_INLINE V3 reflectance(const Reflectances& table, V cosine, V roughness, const V3& f0) {
  const D d;
  const DI di;
  constexpr int kWidth = Reflectances::kCosines, kHeight = Reflectances::kRoughnesses;
  const V x = hn::Sqrt(saturate(cosine)) * set(kWidth - 1),
          y = saturate(roughness) * set(kHeight - 1);
  const VI x0 = hn::Min(hn::ConvertTo(di, x), set_int(kWidth - 2)),
           y0 = hn::Min(hn::ConvertTo(di, y), set_int(kHeight - 2));
  const V fx = x - hn::ConvertTo(d, x0), fy = y - hn::ConvertTo(d, y0);
  const VI node = (y0 * set_int(kWidth) + x0) * set_int(2);
  const auto sum = [&](int which) HWY_ATTR {
    const float* from = table.data() + which;
    const V a = gather(from, node), b = gather(from + 2 * kWidth, node);
    const V top = hn::MulAdd(fx, gather(from + 2, node) - a, a),
            bottom = hn::MulAdd(fx, gather(from + 2 * kWidth + 2, node) - b, b);
    return hn::MulAdd(fy, bottom - top, top);
  };
  const V rise = sum(1);
  return mul_add(f0, sum(0), V3{rise, rise, rise});
}

/// F0 + (1 - F0) rise.
HWY_INLINE V3 fresnel(const V3& f0, V facing) {
  const V rise = fresnel_rise(facing);
  return mul_add(f0, set(1) - rise, V3{rise, rise, rise});
}

/// The light of the sky over that of an even one.
HWY_INLINE V3 mirrored_sky(const MirrorModel& model, const std::vector<FacetPoint>& points,
                           const MirrorFrame& frame, const V3& f0) {
  V3 light = set(glm::vec3(0)), all = light;
  for (const FacetPoint& point : points) {
    const FacetRays r = frame.rays(point);
    const V3 weight = fresnel(f0, r.facing) * r.share;
    const V solid_angle = set(1 / float(points.size())) / r.density;
    light = light + weight * look_up(model.sky, r.to, solid_angle);
    all = all + weight;
  }
  const auto mean = [](V sum, V weights) HWY_ATTR {
    return hn::IfThenElseZero(weights > set(0), sum / hn::Max(weights, set(1e-30f)));
  };
  return {mean(light.x, all.x), mean(light.y, all.y), mean(light.z, all.z)};
}

/// The points of a source, the same for all receivers.
struct MirroredSource {
  const Source* source;
  std::array<glm::vec3, kSourcePoints> points;

  explicit MirroredSource(const Source& of) : source(&of) {
    for (int k = 0; k < kSourcePoints; ++k)
      points[std::size_t(k)] = of.point(sobol_point(std::uint32_t(k), 0));
  }
};

/// The solid angle of what these directions are spread over evenly: of a disc and of a rectangle,
/// 4 pi and 12 times the root of the determinant of their covariance across the line of sight,
/// which is the sum of the principal minors where that along it is 0.
HWY_INLINE V solid_angle_of(const V3* to, int count) {
  V3 mean = set(glm::vec3(0));
  for (int k = 0; k < count; ++k) mean = mean + to[k];
  mean = mean * set(1 / float(count));
  const V zero = set(0);
  V xx = zero, yy = zero, zz = zero, xy = zero, yz = zero, zx = zero;
  for (int k = 0; k < count; ++k) {
    const V3 off = to[k] - mean;
    xx = hn::MulAdd(off.x, off.x, xx), xy = hn::MulAdd(off.x, off.y, xy);
    yy = hn::MulAdd(off.y, off.y, yy), yz = hn::MulAdd(off.y, off.z, yz);
    zz = hn::MulAdd(off.z, off.z, zz), zx = hn::MulAdd(off.z, off.x, zx);
  }
  const V minors = (xx * yy - xy * xy) + (yy * zz - yz * yz) + (zz * xx - zx * zx);
  return set(12.3f / float(count)) * hn::Sqrt(hn::Max(minors, zero));
}

/// How many points are summed for a source of this solid angle, a power of two, by how wide they
/// make the lobe, which is as narrow across as the viewer's cosine is small, beside what the facets
/// do.
HWY_INLINE V points_for(V solid_angle, V alpha2, V cosine) {
  const V wanted = set(6) * solid_angle / (alpha2 * hn::Max(cosine, set(0.05f)));
  V count = set(kLeastSourcePoints);
  for (int n = kLeastSourcePoints; n < kSourcePoints; n *= 2)
    count = hn::IfThenElse(wanted > set(float(n)), set(float(2 * n)), count);
  return count;
}

HWY_INLINE V3 mirrored_source(const MirroredSource& of, const V3& position,
                              const MirrorFrame& frame, const V3& f0) {
  const V zero = set(0), half = set(0.5f), alpha2 = frame.alpha * frame.alpha;
  V3 to[kLeastSourcePoints];
  V weight[kLeastSourcePoints];
  const auto look_at = [&](int k, V3& direction, V& light) HWY_ATTR {
    const SourcePoints point = seen(*of.source, position, set(of.points[std::size_t(k)]));
    direction = point.to, light = point.weight;
  };
  for (int k = 0; k < kLeastSourcePoints; ++k) look_at(k, to[k], weight[k]);
  const V solid_angle = solid_angle_of(to, kLeastSourcePoints),
          count = points_for(solid_angle, alpha2, frame.cosine);
  const V widening = solid_angle * set(kOverlap / (4 * glm::pi<float>())) / count;
  const int most = int(hn::GetLane(hn::MaxOfLanes(D(), count)));
  V3 sum = set(glm::vec3(0));
  for (int k = 0; k < most; ++k) {
    V3 l;
    V light;
    if (k < kLeastSourcePoints)
      l = to[k], light = weight[k];
    else
      look_at(k, l, light);
    const V lx = dot(l, frame.x), ly = dot(l, frame.y), lz = dot(l, frame.normal);
    const V facing2 = hn::MulAdd(half, hn::MulAdd(frame.sine, lx, frame.cosine * lz), half),
            facing = hn::Sqrt(hn::Max(facing2, set(1e-6f))), scale = half / facing;
    const V3 facet{(frame.sine + lx) * scale, ly * scale, (frame.cosine + lz) * scale};
    const V density =
        frame.density(facet, alpha2 + widening, alpha2 + widening / hn::Max(facing2, set(1e-6f)));
    const M counts = hn::And(lz > zero, set(float(k)) < count);
    const V mirrored = hn::IfThenElseZero(counts, light * density * smith_share(lz, frame.alpha));
    sum = mul_add(fresnel(f0, facing), mirrored, sum);
  }
  return sum * set(of.source->irradiance) *
         (set(glm::pi<float>() / 4) * frame.seen / (frame.cosine * count));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
