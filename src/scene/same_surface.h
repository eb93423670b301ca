// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

// How much a point q with a normal n_q is on the surface of p, after Ritschel, Grosch and Seidel
// (2009), section 5:
//
//   ramp(s / kPlaneSine) ramp((1 - n_p . n_q) / (1 - kNormalCosine))
//   s = |n_p . (q - p)| / |q - p|,   ramp(x) = 1 up to 1/2, falling to 0 at 1
//
// s is the sine of the angle by which q leaves the tangent plane of p, so that the weight knows no
// unit and no resolution. The flat part matters: where a surface bends gently, all neighbours have
// to weigh the same, or the sampling pattern shows through a mean over it.
//
// The vector form is in same_surface-inl.h.
constexpr float kPlaneSine = 0.3f;  ///< of 17 degrees: what leaves the plane by more is not on it
constexpr float kNormalCosine = 0.8f;  ///< normals 37 degrees apart share nothing

}  // namespace ssdo
