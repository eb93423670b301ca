// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numeric>

#include "math/order_statistics.h"
#include "parallel/tiles.h"
#include "scene/camera/find_camera.h"
#include "scene/normals/normal_space.h"
#include "scene/normals/normals.h"
#include "scene/normals/world_of_normals.h"
#include "scene/silhouettes.h"

namespace ssdo {
namespace {

/// Camera-space positions, and the radius by which rounding may have moved each of them. Returns
/// how many were left out because they lie behind the camera.
std::size_t place_positions(const GBuffer& g, const Camera& camera, Geometry& out) {
  std::vector<std::size_t> behind(std::size_t(out.surfel.height));
  for_each_row(out.surfel.height, [&](int y) {
    for (int x = 0; x < out.surfel.width; ++x) {
      const std::size_t i = out.surfel.index(x, y);
      if (!g.valid[i]) continue;
      glm::dvec3 p;
      double magnitude;
      if (g.position.empty()) {
        const glm::dvec2 centre(g.window.x0 + x + 0.5, g.window.y0 + y + 0.5);
        p = camera.unproject(centre, g.depth[i]);
        if (g.depth_kind == DepthKind::ray && !camera.orthographic) {
          p *= g.depth[i] / glm::length(p);
        }
        magnitude = g.depth[i];
      } else {
        p = camera.to_camera(glm::dvec3(g.position[i]));
        magnitude = std::max(
            {std::abs(g.position[i].x), std::abs(g.position[i].y), std::abs(g.position[i].z)});
      }
      if (!camera.panorama && !(float(p.z) < 0)) {
        ++behind[std::size_t(y)];
        continue;
      }
      out.surfel[i].position = glm::vec3(p);
      out.surfel[i].valid = 1;
      out.surfel[i].rounding = float(magnitude) * g.position_step;
    }
  });
  return std::accumulate(behind.begin(), behind.end(), std::size_t(0));
}

/// The spaces that N may be in.
std::vector<NamedRotation> spaces_of_normals(const GBuffer& g, const Placement& found,
                                             bool by_header) {
  const glm::mat3 of_positions(found.of_positions.rotation), world(found.camera.rotation);
  std::vector<NamedRotation> spaces;
  if (!g.position.empty()) spaces.push_back({of_positions, "the space of P"});
  spaces.push_back({glm::mat3(1), "camera space"});
  if (found.world_given && (g.position.empty() || of_positions != world))
    spaces.push_back({world, by_header ? "the world of the header" : "the world of --camera"});
  return spaces;
}

/// How the stored normals are to be used; nothing where they are not to be, and why in `report`.
std::optional<NormalSpace> usable_normal_space(const GBuffer& g, const Geometry& out,
                                               GeometryReport& report) {
  if (g.normal.empty()) return std::nullopt;
  NormalSpace space = find_normal_space(
      g.normal, out.surfel, spaces_of_normals(g, report.placement, report.header.has_value()),
      out.camera.orthographic);
  report.normal_agreement = space.share;
  const bool from_depth = g.position.empty();
  if (space.smooth_pixels < NormalSpace::kFewestSmoothPixels && !from_depth) {
    space.name += ", unchecked: P is nowhere smooth";
    return space;
  }
  if (space.share >= NormalSpace::kLeastShare) return space;
  report.warnings.push_back(
      fmt::format("normals do not belong to {0}: whatever their space and axes, they agree with it "
                  "in {1:.0f} % "
                  "of the smooth pixels; rebuilt from {0}",
                  from_depth ? "the depth" : "P", 100 * space.share));
  return std::nullopt;
}

void place_normals(const GBuffer& g, const std::optional<glm::mat3>& to_camera, Geometry& out,
                   GeometryReport& report) {
  const bool orthographic = out.camera.orthographic;
  Plane<unsigned char> fate(out.surfel.width, out.surfel.height);  // 1 rebuilt, 2 turned
  for_each_row(out.surfel.height, [&](int y) {
    for (int x = 0; x < out.surfel.width; ++x) {
      const std::size_t i = out.surfel.index(x, y);
      if (!out.is_surface(i)) continue;
      const glm::vec3& p = out.surfel[i].position;
      const auto gradient = [&] {
        return gradient_normal(out.surfel, x, y, direction_to_viewer(p, orthographic));
      };
      glm::vec3 n = to_camera ? *to_camera * g.normal[i] : glm::vec3(0);
      const float length = glm::length(n);
      if (length > 1e-4f && length < 1e4f) {
        n /= length;
        // A smooth normal may lean away from the viewer at a silhouette; one that is opposite to
        // what P shows is the back of the surface.
        const bool leans_away = orthographic ? n.z < 0 : glm::dot(n, p) > 0;
        if (leans_away && glm::dot(n, gradient()) < 0) {
          n = -n;
          fate[i] = 2;
        }
      } else {
        n = gradient();
        if (n == glm::vec3(0)) n = direction_to_viewer(p, orthographic);
        fate[i] = 1;
      }
      out.surfel[i].normal = n;
    }
  });
  for (unsigned char f : fate.pixels) {
    report.normals_rebuilt += f == 1;
    report.normals_turned += f == 2;
  }
}

void find_normals(const GBuffer& g, const Geometry& out, GeometryReport& report) {
  const std::optional<NormalSpace> space = usable_normal_space(g, out, report);
  if (space) report.placement.normals_to_camera = space->to_camera;
  report.normal_space = space ? space->name : "rebuilt from P";
}

/// Where P is filtered, as edges of the whole frame tell, its averages go back to surfaces.
void mend(const GBuffer& g, Geometry& out, GeometryReport& report, const Placement* known) {
  Placement& placement = report.placement;
  if (known) {
    if (known->mends_silhouettes) mend_silhouettes(out, placement.residual, true);
    return;
  }
  if (!report.residual || out.camera.panorama) return;
  const double stride = g.grid.stride;
  placement.residual = {stride * report.residual->median_px, stride * report.residual->p99_px,
                        stride * report.residual->max_px};
  const std::size_t averages = mend_silhouettes(out, *report.residual);
  placement.mends_silhouettes = averages > 0;
  if (averages == 0) return;
  report.warnings.push_back(fmt::format(
      "P is an average over an edge in {} pixels, which take the surface beside them; export P "
      "and N without a filter",
      averages));
}

float median_depth(const Geometry& geometry) {
  constexpr float kLeftOut = -1;
  Plane<float> depths = Plane<float>::like(geometry.surfel);
  for_each_row(depths.height, [&](int y) {
    for (int x = 0; x < depths.width; ++x) {
      const Surfel& s = geometry.surfel(x, y);
      depths(x, y) = s.is_surface() ? float(geometry.camera.depth_of(s.position)) : kLeftOut;
    }
  });
  const OrderStatistics in_order(depths.pixels);
  return in_order.count() == 0 ? 0 : in_order.at(in_order.count() / 2);
}

}  // namespace

float Geometry::frame_height_at(float depth) const {
  return float(display.height() / camera.fy * (camera.orthographic ? 1.0 : depth));
}

Geometry build_geometry(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report, const Placement* known) {
  Geometry out;
  out.window = g.window;
  out.display = g.display;
  out.part_of = g.part_of;
  out.surfel = Plane<Surfel>(g.window.width(), g.window.height());
  // Nor is the camera known where the overview of a frame shows none.
  if (known && known->median_depth <= 0) return out;
  if (!known && g.background_pixels + g.bad_pixels >= g.valid.size() &&
      std::none_of(g.valid.pixels.begin(), g.valid.pixels.end(), [](auto v) { return v != 0; })) {
    report.camera_source = "none: the frame shows no surface";
    report.warnings.push_back("the frame shows no surface");
    return out;
  }
  Placement& placement = report.placement;
  std::vector<HeaderCamera> readings;
  if (known) {
    placement = *known;
  } else {
    const FoundCamera found = find_camera(g, options, file, report);
    placement.camera = found.camera, placement.of_positions = found.of_positions;
    placement.world_given = found.world_given;
    readings = found.readings;
  }
  out.camera = to_grid(placement.camera, g.grid);
  if (const std::size_t behind = place_positions(g, to_grid(placement.of_positions, g.grid), out)) {
    report.warnings.push_back(
        fmt::format("{} positions lie behind the camera and are left out", behind));
  }
  if (!readings.empty()) {
    settle_world(g, out.surfel, readings, report);
    out.camera = to_grid(placement.camera, g.grid);
  }
  if (!known) find_normals(g, out, report);
  out.normals_to_camera =
      placement.normals_to_camera.value_or(glm::mat3(placement.of_positions.rotation));
  place_normals(g, placement.normals_to_camera, out, report);
  mend(g, out, report, known);
  if (!known) {
    placement.median_depth = median_depth(out);
    placement.world_known =
        placement.world_given ||
        (!g.position.empty() && !out.camera.is_camera_space(placement.median_depth));
  }
  out.median_depth = placement.median_depth;
  out.world_known = placement.world_known;
  if (out.world_known) out.world_to_camera = glm::mat3(out.camera.rotation);
  return out;
}

}  // namespace ssdo
