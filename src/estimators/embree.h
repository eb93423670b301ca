// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Embree 3 and Embree 4 under the same names. They differ in where the filter of a query stands:
/// in its context, or in the arguments of the call. CMake sets SSDO_EMBREE to the one it has found.
#if SSDO_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace ssdo {

#if SSDO_EMBREE >= 4

using RayContext = RTCRayQueryContext;
inline constexpr RTCSceneFlags kFilterOfQuery = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

inline void init_context(RayContext& context) { rtcInitRayQueryContext(&context); }

/// `arguments` of either query, initialised.
template <class Arguments>
void set_filter(Arguments& arguments, RayContext& context, RTCFilterFunctionN filter) {
  arguments.context = &context;
  arguments.filter = filter;
  arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
}

/// Traces a ray up to the first triangle that `filter` accepts; null: that is met.
inline void trace_first(RTCScene scene, RayContext& context, RTCFilterFunctionN filter,
                        RTCRayHit& ray) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  set_filter(arguments, context, filter);
  rtcIntersect1(scene, &ray, &arguments);
}

/// Traces a ray up to any triangle that `filter` accepts: `ray.tfar` is below 0 if there is one.
inline void trace_any(RTCScene scene, RayContext& context, RTCFilterFunctionN filter, RTCRay& ray) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  set_filter(arguments, context, filter);
  rtcOccluded1(scene, &ray, &arguments);
}

#else

using RayContext = RTCIntersectContext;
inline constexpr RTCSceneFlags kFilterOfQuery = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

inline void init_context(RayContext& context) { rtcInitIntersectContext(&context); }

inline void trace_first(RTCScene scene, RayContext& context, RTCFilterFunctionN filter,
                        RTCRayHit& ray) {
  context.filter = filter;
  rtcIntersect1(scene, &context, &ray);
}

inline void trace_any(RTCScene scene, RayContext& context, RTCFilterFunctionN filter, RTCRay& ray) {
  context.filter = filter;
  rtcOccluded1(scene, &context, &ray);
}

#endif

}  // namespace ssdo
