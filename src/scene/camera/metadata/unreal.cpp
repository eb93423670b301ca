// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/metadata/unreal.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>

namespace ssdo {

glm::dmat3 rotation_of(const UnrealRotation& rotation) {
  const double p = glm::radians(rotation.pitch), y = glm::radians(rotation.yaw),
               r = glm::radians(rotation.roll);
  const double cp = std::cos(p), sp = std::sin(p), cy = std::cos(y), sy = std::sin(y),
               cr = std::cos(r), sr = std::sin(r);
  const glm::dvec3 view(cp * cy, cp * sy, sp),
      right(sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, -sr * cp),
      up(-cr * sp * cy - sr * sy, -cr * sp * sy + sr * cy, cr * cp);
  return glm::transpose(glm::dmat3(right, up, -view));
}

}  // namespace ssdo
