// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Has OpenEXR, and OpenImageIO where it is loaded later, read and write with `count` threads from
/// now on.
void limit_io_threads(int count);

/// The latest `count`; 0 before the first.
int io_threads();

}  // namespace ssdo
