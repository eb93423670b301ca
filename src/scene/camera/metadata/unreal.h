// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>

namespace ssdo {

/// An FRotator of Unreal, in degrees.
struct UnrealRotation {
  double pitch = 0, yaw = 0, roll = 0;
};

/// The rotation of Camera for it. Unreal's world is left-handed, z up; a camera without rotation
/// looks along x, with y to its right. Roll turns it about its view first, y towards -z, then pitch
/// lifts the view from x towards z, then yaw turns it from x towards y. The axes of the camera are
/// then, in the world,
///
///   view  = (cp cy, cp sy, sp)
///   right = (sr sp cy - cr sy, sr sp sy + cr cy, -sr cp)
///   up    = (-cr sp cy - sr sy, -cr sp sy + sr cy, cr cp)
///
/// cp the cosine of pitch, sp its sine, and so on: the rows of Unreal's FRotationMatrix.
glm::dmat3 rotation_of(const UnrealRotation& rotation);

}  // namespace ssdo
