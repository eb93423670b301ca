// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "estimators/estimator.h"
#include "filters/filter_planes.h"
#include "filters/shadow_filter.h"

namespace ssdo {

/// A row in the table of filters.
struct Filter {
  std::string_view name, summary;
  /// Takes away the noise of a T x T sampling pattern; `guide` is what each pixel shows. Null:
  /// leaves the planes as they are.
  FilterPlanes (*apply)(FilterPlanes noisy, const Surfaces& guide, int pattern_size);
  int reach = 0;  ///< pixels on each side that a pixel depends on, for patterns of up to 8 x 8
  /// Filters the visibility of a sun that was found with one ray per pixel; null: `apply` does it.
  Plane<float> (*shadow)(NoisyShadow noisy, const Surfaces& guide, int pattern_size) = nullptr;
};

/// Stands for the filter with which the source of each method ends.
inline constexpr std::string_view kPublishedFilter = "source";

/// Every filter, in the order of --help.
std::span<const Filter> filters();

/// Errors: ExitCode::usage with the names that exist.
const Filter& find_filter(std::string_view name);

/// The filter that a name, which may be kPublishedFilter, means for a method. Errors: as above.
const Filter& find_filter(std::string_view name, const Method& method);

/// Filters one plane alone.
Plane<float> apply_filter(const Filter& filter, Plane<float> noisy, const Filtering& filtering,
                          const Surfaces& guide, int pattern_size);

}  // namespace ssdo
