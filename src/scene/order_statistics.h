// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

namespace ssdo {

/// What stands at given places of many numbers in ascending order, without sorting them. Numbers
/// without a sign are ordered as their bits are: they are counted by the upper half of these, and
/// only those that share it with the one looked for are compared.
class OrderStatistics {
 public:
  /// Numbers with a sign are left out. `values` have to outlive this.
  explicit OrderStatistics(std::span<const float> values) : values_(values), counts_(kUppers) {
    for (const float value : values) ++counts_[upper_of(value)];
    for (std::size_t upper = 0; upper < kUppers / 2; ++upper) count_ += counts_[upper];
  }

  std::size_t count() const { return count_; }

  /// The number at `place`, from 0 to below count().
  float at(std::size_t place) const {
    std::size_t upper = 0;
    for (; counts_[upper] <= place; ++upper) place -= counts_[upper];
    std::vector<float> alike;
    alike.reserve(counts_[upper]);
    std::copy_if(values_.begin(), values_.end(), std::back_inserter(alike),
                 [&](float value) { return upper_of(value) == upper; });
    const auto wanted = alike.begin() + std::ptrdiff_t(place);
    std::nth_element(alike.begin(), wanted, alike.end());
    return *wanted;
  }

 private:
  static constexpr std::size_t kUppers = 1 << 16;

  static std::size_t upper_of(float value) { return std::bit_cast<std::uint32_t>(value) >> 16; }

  std::span<const float> values_;
  std::vector<std::size_t> counts_;
  std::size_t count_ = 0;
};

}  // namespace ssdo
