// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace ssdo {

/// Chooses the instruction set that the vector loops of the whole process run on from now on:
/// `wanted`, which is what $SSDO_ISA holds (avx512, avx2, neon or scalar), or where it is empty the
/// best that this processor has. Gives its name. No loop may be running. A process that never calls this
/// runs on the best one: Highway looks at the processor when the first loop starts.
/// Errors: ExitCode::usage for a name that is none or that the processor lacks; nothing changes.
std::string choose_isa(std::string_view wanted);

}  // namespace ssdo
