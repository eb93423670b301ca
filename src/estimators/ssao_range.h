// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

Method ssao_range_method();

}  // namespace ssdo
