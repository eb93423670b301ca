// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <glm/gtc/type_ptr.hpp>

namespace ssdo {

inline Eigen::Vector3d eigen(const glm::dvec3& v) { return Eigen::Vector3d(glm::value_ptr(v)); }
inline Eigen::Matrix3d eigen(const glm::dmat3& m) { return Eigen::Matrix3d(glm::value_ptr(m)); }

}  // namespace ssdo
