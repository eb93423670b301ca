// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Screen-space directional occlusion as Ritschel, Grosch and Seidel published it; see ssdo.cpp.
Method ssdo_method();

}  // namespace ssdo
