// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Scalable Ambient Obscurance as McGuire, Mara and Luebke published it; see sao.cpp.
Method sao_method();

}  // namespace ssdo
