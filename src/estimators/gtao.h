// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Ground-truth ambient occlusion as game engines run it; see gtao.cpp.
Method gtao_method();

}  // namespace ssdo
