// SPDX-License-Identifier: Apache-2.0
#include "filters/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "error.h"
#include "filters/box_filter.h"
#include "filters/depth_filter.h"
#include "filters/gaussian_filter.h"
#include "filters/geometry_filter.h"
#include "filters/normal_filter.h"
#include "nearest_name.h"

namespace ssdo {

std::span<const Filter> filters() {
  static const std::array<Filter, 6> all = {{
      {"none", "leaves the sampling pattern", nullptr},
      {"box", "mean over the pattern, across edges", filter_box, 4},
      {"gaussian", "Gaussian within a depth and a cone of normals", filter_gaussian, 15},
      {"normal", "seven taps, by normals", filter_normal, 3},
      {"depth", "nine taps two pixels apart, by depth", filter_depth, 8},
      {"geometry", "mean over the pattern on one surface", filter_geometry, 8, filter_shadow},
  }};
  return all;
}

const Filter& find_filter(std::string_view name) {
  std::vector<std::string> names;
  for (const Filter& filter : filters()) {
    if (filter.name == name) return filter;
    names.emplace_back(filter.name);
  }
  names.emplace_back(kPublishedFilter);
  throw Error(ExitCode::usage, fmt::format("--filter {}: no such filter; {}there is {}", name,
                                           did_you_mean(name, names), fmt::join(names, ", ")));
}

const Filter& find_filter(std::string_view name, const Method& method) {
  return find_filter(name == kPublishedFilter ? method.published_filter.name : name);
}

Plane<float> apply_filter(const Filter& filter, Plane<float> noisy, const Filtering& filtering,
                          const Surfaces& guide, int pattern_size) {
  if (!filter.apply) return noisy;
  FilterPlanes planes;
  planes.push_back({std::move(noisy), filtering});
  return std::get<Plane<float>>(filter.apply(std::move(planes), guide, pattern_size).front().plane);
}

}  // namespace ssdo
