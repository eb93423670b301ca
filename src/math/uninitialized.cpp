// SPDX-License-Identifier: Apache-2.0
#include "math/uninitialized.h"

#include <sys/mman.h>

#include <cstdint>

namespace ssdo {

void prefer_large_pages(void* first, std::size_t bytes) {
  constexpr std::uintptr_t kLargePage = std::uintptr_t(2) << 20;
  if (bytes < 2 * kLargePage) return;
  // Only pages that the plane fills: the memory beside it may never be touched. On a system without
  // large pages nothing changes.
  const std::uintptr_t begin = (std::uintptr_t(first) + kLargePage - 1) & -kLargePage,
                       end = (std::uintptr_t(first) + bytes) & -kLargePage;
  static_cast<void>(madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
}

}  // namespace ssdo
