// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace ssdo {

struct FreeMemory {
  void operator()(void* memory) const { std::free(memory); }
};

/// Floats, not initialised, aligned to a cache line.
using PageArray = std::unique_ptr<float[], FreeMemory>;

/// Asks for pages of 2 MiB where the array fills one: the first touch of a page of 4 KiB costs more
/// than most of what is done with it. Errors: std::bad_alloc.
PageArray make_page_array(std::size_t count);

}  // namespace ssdo
