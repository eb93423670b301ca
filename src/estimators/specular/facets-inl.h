// SPDX-License-Identifier: Apache-2.0
//
// estimators/microfacets.h for vectors of surfaces; compiled once for every instruction set.
#if defined(SSDO_SPECULAR_FACETS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SPECULAR_FACETS_INL_H_
#undef SSDO_SPECULAR_FACETS_INL_H_
#else
#define SSDO_SPECULAR_FACETS_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A point of the unit square, as visible_facet() uses it: the first picture's point and half the
/// height of the disc there.
struct FacetPoint {
  float x, y, whole;

  explicit FacetPoint(const glm::vec2& u) {
    const float r = std::sqrt(u.x), azimuth = 2 * glm::pi<float>() * u.y;
    x = r * std::cos(azimuth), y = r * std::sin(azimuth);
    whole = std::sqrt(std::max(0.0f, 1 - x * x));
  }
};

/// smith_share()
HWY_INLINE V smith_share(V cosine, V alpha) {
  const V cosine2 = cosine * cosine, sine2 = set(1) - cosine2;
  return set(2) * cosine / (cosine + hn::Sqrt(hn::MulAdd(alpha * alpha, sine2, cosine2)));
}

/// fresnel_rise()
HWY_INLINE V fresnel_rise(V cosine) {
  const V c = saturate(set(1) - cosine), c2 = c * c;
  return c2 * c2 * c;
}

/// Light from a facet, as FacetSample has it, and beside it the cosine to the facet and the density
/// of the direction.
struct FacetRays {
  V3 to;  ///< in the space of the normals
  V share, facing, density;
};

/// Surfaces with the viewer in the plane of `x` and the normal.
struct MirrorFrame {
  static constexpr float kEdgeOn = 1e-3f;

  V3 x, y, normal;
  V sine, cosine;  ///< of the viewer to the normal
  V alpha;
  V stretched_x, stretched_z;  ///< the viewer where the facets are those of a half-ball
  V seen;                      ///< smith_share() of the viewer

  /// `normal` and `viewer` are unit. A viewer behind the surface, as normal maps have it, sees it
  /// edge-on.
  HWY_INLINE MirrorFrame(const V3& n, const V3& viewer, V roughness)
      : normal(n), cosine(hn::Clamp(dot(n, viewer), set(kEdgeOn), set(1))) {
    constexpr float kSharpest = 1e-3f;
    sine = hn::Sqrt(set(1) - cosine * cosine);
    alpha = hn::Max(roughness * roughness, set(kSharpest));
    const V3 across = mul_add(n, hn::Neg(dot(n, viewer)), viewer);
    const M along_normal = dot(across, across) < set(1e-10f);
    const V3 any_across =
        if_then_else(hn::Abs(n.x) < set(0.7f), set(glm::vec3(1, 0, 0)), set(glm::vec3(0, 1, 0)));
    x = if_then_else(along_normal, unit_across(any_across, n), normalise(across));
    y = cross(n, x);
    const V stretched = alpha * sine,
            scale = set(1) / hn::Sqrt(hn::MulAdd(stretched, stretched, cosine * cosine));
    stretched_x = stretched * scale, stretched_z = cosine * scale;
    seen = smith_share(cosine, alpha);
  }

  /// mirror_at_facet() for a viewer in the plane of x and z.
  HWY_INLINE FacetRays rays(const FacetPoint& at) const {
    const V zero = set(0), half = set(0.5f);
    const V share = hn::MulAdd(half, stretched_z, half), whole = set(at.whole);
    const V b = hn::MulAdd(share, set(at.y), (set(1) - share) * whole),
            v = hn::Sqrt(hn::Max(hn::NegMulAdd(b, b, whole * whole), zero));
    const V3 facet =
        normalise({alpha * hn::MulSub(v, stretched_x, stretched_z * b), alpha * set(at.x),
                   hn::Max(hn::MulAdd(stretched_x, b, v * stretched_z), zero)});
    FacetRays found;
    found.facing = hn::MulAdd(sine, facet.x, cosine * facet.z);
    const V twice = set(2) * found.facing;
    const V lx = hn::MulSub(twice, facet.x, sine), ly = twice * facet.y,
            lz = hn::MulSub(twice, facet.z, cosine);
    found.to = mul_add(x, lx, mul_add(y, ly, normal * lz));
    found.share = hn::IfThenElseZero(lz > zero, smith_share(lz, alpha));
    found.density = seen * density(facet, alpha * alpha) / (set(4) * cosine);
    return found;
  }

  /// facet_density()
  HWY_INLINE V density(const V3& facet, V alpha2) const {
    const V q =
        hn::MulAdd(alpha2 * facet.z, facet.z, hn::MulAdd(facet.x, facet.x, facet.y * facet.y));
    return alpha2 / (set(glm::pi<float>()) * q * q);
  }

  /// The same where the squares of alpha along x and y differ (Heitz 2018, equation 1).
  HWY_INLINE V density(const V3& facet, V along2, V across2) const {
    const V alpha2 = hn::Sqrt(along2 * across2), scale = alpha2 / along2;
    const V q =
        hn::MulAdd(alpha2 * facet.z, facet.z,
                   hn::MulAdd(facet.x * scale, facet.x, alpha2 / across2 * facet.y * facet.y));
    return alpha2 / (set(glm::pi<float>()) * q * q);
  }
};

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
