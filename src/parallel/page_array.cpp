// SPDX-License-Identifier: Apache-2.0
#include "parallel/page_array.h"

#include <sys/mman.h>

#include <new>

namespace ssdo {

PageArray make_page_array(std::size_t count) {
  constexpr std::size_t kHugePage = std::size_t(2) << 20, kCacheLine = 64;
  const std::size_t wanted = count * sizeof(float);
  const std::size_t unit = wanted >= kHugePage ? kHugePage : kCacheLine;
  // A size of aligned_alloc is a multiple of its alignment.
  const std::size_t bytes = (wanted + unit - 1) / unit * unit;
  void* memory = std::aligned_alloc(unit, bytes);
  if (!memory) throw std::bad_alloc();
  // A kernel that has no such pages gives small ones: slower, not wrong.
  if (unit == kHugePage) madvise(memory, bytes, MADV_HUGEPAGE);
  return PageArray(static_cast<float*>(memory));
}

}  // namespace ssdo
