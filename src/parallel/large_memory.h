// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/mman.h>

#include <cstdint>
#include <memory>
#include <new>
#include <utility>

namespace ssdo {

/// Asks for large pages where these bytes will lie. Page by page of 4 KiB, the system's part in
/// first using a plane takes as long as a march over it.
inline void advise_large_pages(void* memory, std::size_t bytes) {
  constexpr std::uintptr_t kPage = 4096;
  constexpr std::size_t kLarge = 4 << 20;
  if (bytes < kLarge) return;
  const auto first = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t begin = (first + kPage - 1) / kPage * kPage,
                       end = (first + bytes) / kPage * kPage;
  madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // no harm where refused
}

/// The allocator of planes. Elements that are given no value are left as they are in memory, so
/// that the threads which fill a plane are the first to touch it.
template <class T>
struct LargeMemory : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = LargeMemory<U>;
  };

  T* allocate(std::size_t count) {
    T* memory = std::allocator<T>::allocate(count);
    advise_large_pages(memory, count * sizeof(T));
    return memory;
  }

  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

}  // namespace ssdo
