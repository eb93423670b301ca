// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Rays against the frame as thick solids, the yardstick; see trace.cpp.
Method trace_method();

}  // namespace ssdo
