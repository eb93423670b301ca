// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Slices with a visibility bitmask, the default; see bitmask.cpp.
Method bitmask_method();

}  // namespace ssdo
