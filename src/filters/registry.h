// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// A row in the table of filters.
struct Filter {
  std::string_view name, summary;
  /// Takes away the noise of a T x T sampling pattern; null: leaves the products as they are.
  Products (*apply)(Products noisy, const Geometry& geometry, int pattern_size);
  int reach = 0;  ///< pixels on each side that a pixel depends on, for patterns of up to 8 x 8
};

/// In place of the name of a filter: that of each method's own source.
inline constexpr std::string_view kSourceFilter = "source";

/// Every filter, in the order of --help.
std::span<const Filter> filters();

/// Errors: ExitCode::usage with the names that exist.
const Filter& find_filter(std::string_view name);

/// What the name, which may be kSourceFilter, means for a method. Errors: as above.
const Filter& find_filter(std::string_view name, const Method& method);

/// The products after the filter.
Products apply_filter(const Filter& filter, Products noisy, const Geometry& geometry,
                      int pattern_size);

}  // namespace ssdo
