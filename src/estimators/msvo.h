// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Multi-Scale Volumetric Obscurance as Unity's package has it; see msvo.cpp.
Method msvo_method();

}  // namespace ssdo
