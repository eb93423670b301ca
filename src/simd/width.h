// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Floats in the widest vector that loops are compiled for, and in a cache line.
constexpr int kMostLanes = 16;

}  // namespace ssdo
