// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace ssdo {

/// Asks the system for large pages (2 MiB), where it has them, for the memory of a plane: with
/// pages of 4 KiB a frame of 1920 x 1080 causes 66,000 page faults. Only large pages that the plane
/// fills are asked for, and none for a plane below 4 MiB, which may not fill any.
void prefer_large_pages(void* first, std::size_t bytes);

/// An allocator for elements that are left as they are in memory where they are given no value, so
/// that the threads which fill a plane are the first to touch it.
template <class T>
struct Uninitialized : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = Uninitialized<U>;
  };

  T* allocate(std::size_t count) {
    T* const first = std::allocator<T>::allocate(count);
    prefer_large_pages(first, count * sizeof(T));
    return first;
  }

  /// Vectors of GLM that are given no value would be set to 0.
  template <class U>
  void construct(U* at) {
    if constexpr (!std::is_trivially_destructible_v<U>) ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    std::construct_at(at, std::forward<Arguments>(arguments)...);
  }
};

}  // namespace ssdo
