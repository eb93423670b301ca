// SPDX-License-Identifier: Apache-2.0
//
// Light on vectors of surfaces; compiled once for every instruction set.
#if defined(SSDO_SCENE_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_LIGHT_INL_H_
#undef SSDO_SCENE_LIGHT_INL_H_
#else
#define SSDO_SCENE_LIGHT_INL_H_
#endif

#include <cmath>

#include "scene/light/distant_source.h"
#include "scene/light/lamps/lamp_points-inl.h"
#include "scene/light/lamps/local_lamp-inl.h"
#include "scene/light/light.h"
#include "simd/by_lane-inl.h"
#include "simd/lanes-inl.h"
#include "simd/octahedral_map-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The points of a source are looked at only where it crosses the horizon of a lane.
HWY_INLINE V received(const DistantSource& sun, const V3& normal) {
  const V middle = dot(normal, set(sun.direction)), edge = set(std::sin(sun.angular_radius));
  const V whole = hn::IfThenElseZero(middle >= edge, middle);
  const M part = hn::And(middle<edge, middle> hn::Neg(edge));
  if (!any(part)) return whole;
  const V radius = set(sun.point_radius), weight = set(1 / (4 * sun.point_radius));
  V sum = set(0);
  for (const glm::vec3& point : sun.points) {
    const V cosine = dot(normal, set(point));
    const V cut = hn::Max(radius - hn::Abs(cosine), set(0));
    sum = sum + hn::MulAdd(cut * cut, weight, hn::Max(cosine, set(0)));
  }
  return hn::IfThenElse(part, sum * set(1 / float(sun.points.size())), whole);
}

// The functions of Source for vectors. A distant source looks the same from everywhere, so that all
// lanes share its values; lamps have vector forms; for other sources, each lane is computed alone.

HWY_INLINE V received(const Source& source, const V3& position, const V3& normal) {
  if (const DistantSource* distant = source.distant()) return received(*distant, normal);
  if (const LocalLamp* lamp = source.local_lamp()) return received(*lamp, position, normal);
  if (const DistantLamp* lamp = source.distant_lamp()) return received(*lamp, normal);
  const Lanes3 positions(position), normals(normal);
  return by_lane([&](int lane)
                     HWY_ATTR { return source.received(positions[lane], normals[lane]); });
}

HWY_INLINE SourcePoints seen(const Source& source, const V3& position, const V3& point) {
  if (source.distant()) return {point, set(SourcePoint().distance), set(SourcePoint().weight)};
  if (const LocalLamp* lamp = source.local_lamp()) return seen(*lamp, position, point);
  if (const DistantLamp* lamp = source.distant_lamp())
    return {point, set(SourcePoint().distance), set(lamp->weight())};
  const Lanes3 positions(position), points(point);
  SourcePoint found[kLanes];
  for (int lane = 0; lane < kLanes; ++lane)
    found[lane] = source.seen(positions[lane], points[lane]);
  return {{by_lane([&](int lane) HWY_ATTR { return found[lane].to.x; }),
           by_lane([&](int lane) HWY_ATTR { return found[lane].to.y; }),
           by_lane([&](int lane) HWY_ATTR { return found[lane].to.z; })},
          by_lane([&](int lane) HWY_ATTR { return found[lane].distance; }),
          by_lane([&](int lane) HWY_ATTR { return found[lane].weight; })};
}

HWY_INLINE SourceCones cones(const Source& source, const V3& position) {
  if (const LocalLamp* lamp = source.local_lamp()) return cones(*lamp, position);
  if (source.distant() || source.distant_lamp()) {
    const SourceCone cone = source.cone(glm::vec3(0));
    return {set(cone.to), set(cone.angular_radius), set(std::sin(cone.angular_radius))};
  }
  const Lanes3 positions(position);
  SourceCone found[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) found[lane] = source.cone(positions[lane]);
  return {{by_lane([&](int lane) HWY_ATTR { return found[lane].to.x; }),
           by_lane([&](int lane) HWY_ATTR { return found[lane].to.y; }),
           by_lane([&](int lane) HWY_ATTR { return found[lane].to.z; })},
          by_lane([&](int lane) HWY_ATTR { return found[lane].angular_radius; }),
          by_lane([&](int lane) HWY_ATTR { return std::sin(found[lane].angular_radius); })};
}

/// Source::link_weight() of `count` pixels from `first` on; 1 in other lanes.
HWY_INLINE V link_weight(const Source& source, std::size_t first, int count) {
  return source.receivers ? load_first(count, &(*source.receivers)[first]) : set(1);
}

// Source::unoccluded(), Light::unoccluded_sky() and Light::unoccluded().

HWY_INLINE V3 unoccluded(const Source& source, const V3& position, const V3& normal) {
  return set(source.irradiance) * received(source, position, normal);
}

HWY_INLINE V3 unoccluded_sky(const Light& light, const V3& normal) {
  return light.environment.is_constant() ? set(light.environment.constant_radiance())
                                         : look_up(light.irradiance, normal);
}

HWY_INLINE V3 unoccluded(const Light& light, const V3& position, const V3& normal) {
  V3 sum = unoccluded_sky(light, normal);
  for (const auto& source : light.sources) sum = sum + unoccluded(*source, position, normal);
  return sum;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
