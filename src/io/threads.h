// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Has OpenEXR and OpenImageIO read and write with `count` threads from now on.
void limit_io_threads(int count);

}  // namespace ssdo
