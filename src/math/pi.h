// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace ssdo {

constexpr double kPi = std::numbers::pi;
constexpr float kPif = std::numbers::pi_v<float>;

}  // namespace ssdo
