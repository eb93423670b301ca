// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ssdo {

/// Has for_each_tile() and its like begin their work in a random order while it lives, in the whole
/// process, for tests of what must not depend on the order. One at a time.
class ShuffledOrder {
 public:
  /// Each seed but 0 gives another order.
  explicit ShuffledOrder(unsigned seed);
  ~ShuffledOrder();
  ShuffledOrder(const ShuffledOrder&) = delete;
  ShuffledOrder& operator=(const ShuffledOrder&) = delete;
};

}  // namespace ssdo
