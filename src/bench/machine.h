// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace ssdo {

/// What the system calls the processor; "unknown" where it does not tell.
std::string processor_name();

/// Logical processors of the machine.
int processor_count();

}  // namespace ssdo
