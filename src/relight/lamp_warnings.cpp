// SPDX-License-Identifier: Apache-2.0
#include "relight/lamp_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ssdo {
namespace {

/// Surfaces that are looked at: rows and columns of a frame, at most.
constexpr int kLooks = 200;

/// The lamp among the surfaces of a frame.
struct Surroundings {
  bool any = false;            ///< there are surfaces
  bool lights = false;         ///< one of them gets light from it
  double farthest = 0;         ///< depth of a surface
  double nearest = INFINITY;   ///< distance of a surface from the middle of the lamp
  bool before_nearest = true;  ///< the middle is on the side that the nearest surface faces
};

Surroundings look_around(const glm::vec3& center, const Source& source, const Geometry& geometry) {
  Surroundings found;
  const Surfaces& surfels = geometry.surfaces;
  const int step_x = std::max(1, surfels.width / kLooks),
            step_y = std::max(1, surfels.height / kLooks);
  for (int y = step_y / 2; y < surfels.height; y += step_y) {
    for (int x = step_x / 2; x < surfels.width; x += step_x) {
      const Surfel& s = surfels(x, y);
      if (!s.is_surface()) continue;
      found.any = true;
      found.lights = found.lights || source.received(s.position, s.normal) > 0;
      found.farthest = std::max(found.farthest, geometry.camera.depth_of(s.position));
      const glm::vec3 way = center - s.position;
      const double distance = glm::length(way);
      if (distance >= found.nearest) continue;
      found.nearest = distance;
      found.before_nearest = glm::dot(way, s.normal) > 0;
    }
  }
  return found;
}

/// How far behind the surface at its pixel a place is; negative: before it, or none is shown there.
double behind_surface(const glm::dvec3& center, const Geometry& geometry) {
  const glm::dvec2 pixel = geometry.camera.project(center);
  const double x = std::floor(pixel.x) - geometry.window.x0,
               y = std::floor(pixel.y) - geometry.window.y0;
  const Surfaces& surfels = geometry.surfaces;
  if (!(x >= 0 && y >= 0 && x < surfels.width && y < surfels.height)) return -1;
  const Surfel& s = surfels(int(x), int(y));
  if (!s.is_surface()) return -1;
  return geometry.camera.depth_of(center) - geometry.camera.depth_of(s.position);
}

}  // namespace

std::vector<std::string> warnings_of(const Lamp& lamp, const Source& source,
                                     const Geometry& geometry) {
  std::vector<std::string> lines;
  const auto warn = [&](const std::string& what) { lines.push_back(lamp.given_by + ": " + what); };
  if (std::max({source.irradiance.x, source.irradiance.y, source.irradiance.z}) <= 0) {
    warn(fmt::format("{}: it gives no light",
                     lamp.intensity == 0 ? "intensity is 0"
                     : std::max({lamp.color.x, lamp.color.y, lamp.color.z}) == 0
                         ? "color is 0,0,0"
                         : "exposure leaves less than floats hold"));
    return lines;
  }
  const bool is_near = lamp.type != LampType::distant;
  const glm::dvec3 center = geometry.camera.to_camera(lamp.position);
  const Surroundings around = look_around(glm::vec3(center), source, geometry);
  if (!around.any) return lines;
  if (!around.lights) {
    warn(fmt::format("{}: it lights no surface that the frame shows; move or turn it",
                     is_near ? "position and direction" : "direction"));
    return lines;
  }
  const double depth = geometry.camera.depth_of(center), reach = lamp.reach(),
               behind = behind_surface(center, geometry);
  if (!is_near || behind <= reach) return lines;
  if (depth - reach > around.farthest) {
    warn(
        fmt::format("position: at the depth {:.4g}, it is behind all that the frame shows, whose "
                    "farthest surface is at {:.4g}",
                    depth, around.farthest));
  } else if (!around.before_nearest && around.nearest > reach) {
    warn(
        fmt::format("position: it is inside or behind a surface that the frame shows {:.4g} nearer "
                    "to the camera; what is around it blocks its light",
                    behind));
  }
  return lines;
}

}  // namespace ssdo
