// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// What is said where a thread does not start.
inline constexpr const char* kNoThread =
    "a thread could not be started; raise the limits on processes (ulimit -u) and memory "
    "(ulimit -v)";

/// How many threads can live beside each other, up to `most`: starts as many and ends them.
int count_startable(int most);

/// Has TBB start its threads, `count` with this one as ThreadLimit allows, instead of during the
/// work: TBB leaves a loop half done, or ends the process, where one of them does not start.
/// Errors: std::runtime_error where one does not.
void start_threads(int count);

}  // namespace ssdo
