// SPDX-License-Identifier: Apache-2.0
//
// What holds for every frame, as a number and the most that it may be.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "relight/estimate.h"
#include "support/random_shot.h"

namespace ssdo::test {

/// A shot, the frame that its file gives, and what is made of it.
struct Subject {
  const RandomShot& shot;
  const Frame& frame;
  const Estimate& estimate;

  std::string_view method() const { return frame.plan.method->name; }
};

/// The largest of many numbers, none of which should be large, and where it was.
struct Worst {
  double value = 0;
  std::string where = {};

  /// Not-a-number is worse than any number.
  void see(double a_value, const std::function<std::string()>& place);
};

/// Nothing where a property is not promised for such a frame.
using Measured = std::optional<Worst>;

struct FrameProperty {
  std::string_view name;
  double bound;       ///< the most that `measure` may give
  double mean_bound;  ///< of many frames: rounding that takes one sample across an edge is rare
  Measured (*measure)(const Subject&) = nullptr;
  /// Also of a learned prior, which knows which way is up, computes logarithms of lengths, and
  /// keeps no balance of light.
  bool holds_with_prior = true;
};

/// Every property; what each of them is promised for stands where it is measured.
std::span<const FrameProperty> frame_properties();

// What values may be: frame_properties_cases.cpp.
Measured bad_values(const Subject& s);
Measured bad_outputs(const Subject& s);
Measured bad_files(const Subject& s);

// Energy: energy_properties_cases.cpp.
Measured light_gained(const Subject& s);
Measured lost_by_a_bounce(const Subject& s);
Measured lost_by_a_bounce_of_rays(const Subject& s);
Measured lost_by_more_light_of_one_color(const Subject& s);
Measured lost_by_more_light_in_a_map(const Subject& s);
Measured lost_by_more_light_of_a_ratio(const Subject& s);
Measured change_by_twice_the_light(const Subject& s);

// What must not matter: invariance_properties_cases.cpp.
Measured change_in_units_of_a_power_of_two(const Subject& s);
Measured change_in_other_units(const Subject& s);
Measured change_in_a_turned_world(const Subject& s);
Measured change_in_a_moved_world(const Subject& s);
Measured change_by_a_crop(const Subject& s);

/// The products of a scene by a plan, after the filter; --error is not followed.
Products relit(const Scene& scene, Plan plan);

/// A number of the products of two estimates.
struct Pair {
  const Product& product;
  std::size_t pixel;
  double one, other;

  bool is_light() const { return product.kind == ProductKind::light; }
  std::string place() const {
    return fmt::format("{} of pixel {} is {:g} and {:g}", product.name, pixel, one, other);
  }
};

/// Calls visit(pair) for each number of two sets of products.
template <class Visit>
void for_each_pair(const Products& one, const Products& other, const Visit& visit) {
  const auto pair = [&](const Product& product, std::size_t i, float a, float b) {
    visit(Pair{product, i, double(a), double(b)});
  };
  for_each_plane(
      [&](const Product& product, const auto& a, const auto& b) {
        for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
          if constexpr (std::is_same_v<std::decay_t<decltype(a[i])>, float>)
            pair(product, i, a[i], b[i]);
          else
            for (int c = 0; c < 3; ++c) pair(product, i, a[i][c], b[i][c]);
        }
      },
      one, other);
}

/// The largest number of light, at least 1e-30.
inline double brightest_of(const Products& products) {
  double most = 1e-30;
  for_each_pair(products, products, [&](const Pair& pair) {
    if (pair.is_light()) most = std::max(most, std::abs(pair.one));
  });
  return most;
}

}  // namespace ssdo::test
