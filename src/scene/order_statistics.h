// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {

/// The numbers at given places of an ascending order, without sorting. Floats without a sign are
/// ordered as their bits are: they are counted by the upper half of the bits, and only those that
/// share it with the wanted number are compared.
class OrderStatistics {
 public:
  /// Numbers with a sign are left out. `values` have to outlive this.
  explicit OrderStatistics(std::span<const float> values) : values_(values), counts_(kUppers) {
    std::vector<std::vector<std::uint32_t>> of_parts(parts());
    for_each_task(parts(), [&](std::size_t p) {
      of_parts[p].resize(kUppers);
      for (const float value : part(p)) ++of_parts[p][upper_of(value)];
    });
    for (const auto& counts : of_parts)
      for (std::size_t upper = 0; upper < kUppers; ++upper) counts_[upper] += counts[upper];
    for (std::size_t upper = 0; upper < kUppers / 2; ++upper) count_ += counts_[upper];
  }

  std::size_t count() const { return count_; }

  /// The number at `place`, from 0 to below count().
  float at(std::size_t place) const {
    std::size_t upper = 0;
    for (; counts_[upper] <= place; ++upper) place -= counts_[upper];
    std::vector<std::vector<float>> of_parts(parts());
    for_each_task(parts(), [&](std::size_t p) {
      std::ranges::copy_if(part(p), std::back_inserter(of_parts[p]),
                           [&](float value) { return upper_of(value) == upper; });
    });
    std::vector<float> alike;
    alike.reserve(counts_[upper]);
    for (const auto& some : of_parts) alike.insert(alike.end(), some.begin(), some.end());
    const auto wanted = alike.begin() + std::ptrdiff_t(place);
    std::nth_element(alike.begin(), wanted, alike.end());
    return *wanted;
  }

 private:
  static constexpr std::size_t kUppers = 1 << 16;
  static constexpr std::size_t kPart = 1 << 18;  ///< numbers that one task counts

  std::size_t parts() const { return (values_.size() + kPart - 1) / kPart; }
  std::span<const float> part(std::size_t p) const {
    return values_.subspan(p * kPart, std::min(kPart, values_.size() - p * kPart));
  }

  static std::size_t upper_of(float value) { return std::bit_cast<std::uint32_t>(value) >> 16; }

  std::span<const float> values_;
  std::vector<std::size_t> counts_;
  std::size_t count_ = 0;
};

}  // namespace ssdo
