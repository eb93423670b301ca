// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/depth_names.h"

#include <fnmatch.h>

#include <array>

#include "scene/layers/names.h"

namespace ssdo {
namespace {

constexpr std::array<DepthName, 7> kDepthNames = {{
    {"vrayzdepth", DepthKind::normalized, "V-Ray maps it from a black to a white distance"},
    {"zdepth", DepthKind::normalized, "V-Ray and Octane map it to a range that is set there"},
    {"cgeometryzdepth", DepthKind::normalized, "Corona maps it to 0..1, where 1 is near"},
    {"znormalized", DepthKind::normalized, "Redshift maps it to 0..1"},
    {"znormalizedinverted", DepthKind::normalized, "Redshift maps it to 0..1, where 1 is near"},
    {"ray:hitdist", DepthKind::ray, "Karma's distance along the ray"},
    {"*.t", DepthKind::ray, "Mitsuba's distance along the ray"},
}};

bool matches(const DepthName& row, const std::string& text) {
  return fnmatch(std::string(row.name).c_str(), text.c_str(), 0) == 0;
}

}  // namespace

const DepthName* find_depth_name(const Layer& layer) {
  const std::string path = normalise(layer.name), last = path.substr(path.rfind('.') + 1),
                    channel = normalise(layer.channels[0]);
  for (const DepthName& row : kDepthNames) {
    if (matches(row, path) || matches(row, last) || matches(row, channel)) return &row;
  }
  return nullptr;
}

}  // namespace ssdo
