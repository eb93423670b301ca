// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// a / b, b > 0, rounded down or up whatever the sign of a.
constexpr int floor_divide(int a, int b) { return a / b - (a % b < 0); }
constexpr int ceil_divide(int a, int b) { return -floor_divide(-a, b); }

}  // namespace ssdo
