// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ssdo {

/// Chooses the instruction set that vector loops run on: $SSDO_ISA (scalar, avx2 or avx512) where
/// it is set, else the best that this processor has. Gives its name.
/// Errors: ExitCode::usage for a name that is none or that the processor lacks.
std::string choose_isa();

}  // namespace ssdo
