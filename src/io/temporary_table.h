// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// The temporaries that a signal must remove. The table has a fixed size and no locks, because a
/// signal handler may neither allocate nor wait.

/// Enters `path` and returns its slot, or -1 if the path is too long or every slot is taken.
int enter_temporary(const char* path);

/// Frees the slot of a temporary that has been renamed or removed.
void leave_temporary(int slot);

}  // namespace ssdo
