// SPDX-License-Identifier: Apache-2.0
#include "scene/further/further_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "error.h"
#include "parallel/tiles.h"
#include "scene/view.h"

namespace ssdo {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

/// Depths that differ by less than so many footprints are of one surface, tilted as it may be.
constexpr float kSightGap = 3;

/// A view shows what is so many of its pixels wide wherever these fall. With 0, leaves that views
/// look past were carved away: ao of foliage at the small radius .18 in place of .09.
constexpr float kResolved = 3;

/// Most of the median distance by which P may miss its pixel: of another camera than a pinhole or
/// a panorama, or filtered beyond use.
constexpr double kMostMissPx = 0.5;

void check(const View& view, const std::string& file) {
  if (!view.layers[Role::position]) {
    throw Error(ExitCode::layer,
                fmt::format("{}: has no position; a further view needs P in world space", file));
  }
  const Geometry& g = view.geometry;
  if (g.median_depth > 0 && !g.world_known) {
    throw Error(ExitCode::layer, fmt::format("{}: P is in camera space; a further view needs P in "
                                             "world space, as the frame's is",
                                             file));
  }
  if (view.report.residual && view.report.residual->median_px > kMostMissPx) {
    throw Error(ExitCode::layer,
                fmt::format("{}: neither a pinhole camera nor a lat-long panorama shows P where it "
                            "stands (half of it misses its pixel by {:.2g} px or more); render one "
                            "of these",
                            file, view.report.residual->median_px));
  }
}

/// The camera that takes points of the frame's camera space to those of `view`'s.
Camera seen_from(const Camera& view, const Camera& frame) {
  Camera camera = view;
  camera.rotation = view.rotation * glm::transpose(frame.rotation);
  camera.origin = frame.to_camera(view.origin);
  return camera;
}

}  // namespace

FurtherView read_further_view(const std::string& file, const Geometry& frame) {
  View view = read_view(file, {}, {}, {}, {Role::motion, Role::roughness, Role::radiance});
  check(view, file);
  FurtherView out;
  out.file = file;
  out.camera = seen_from(view.geometry.camera, frame.camera);
  out.window = view.geometry.window;
  out.closed = out.camera.panorama && view.geometry.window.width() == view.geometry.display.width();
  out.surfel = std::move(view.geometry.surfel);
  out.depth = Plane<float>(out.surfel.width, out.surfel.height, kNothing);
  const glm::dmat3 to_frame = glm::transpose(out.camera.rotation);
  for_each_row(out.surfel.height, [&](int y) {
    for (int x = 0; x < out.surfel.width; ++x) {
      Surfel& s = out.surfel(x, y);
      if (!s.is_surface()) continue;
      const glm::dvec3 own(s.position);
      out.depth(x, y) = float(out.camera.depth_of(own));
      s.position = glm::vec3(to_frame * own + out.camera.origin);
      s.normal = glm::vec3(to_frame * glm::dvec3(s.normal));
    }
  });
  out.albedo = std::move(view.gbuffer.albedo);
  for (const std::string& warning : view.gbuffer.warnings)
    out.warnings.push_back(file + ": " + warning);
  for (const std::string& warning : view.report.warnings)
    out.warnings.push_back(file + ": " + warning);
  return out;
}

Sight FurtherView::look(const glm::vec3& point, float width) const {
  const glm::dvec3 own = camera.to_camera(glm::dvec3(point));
  const double depth_here = camera.depth_of(own);
  if (!camera.orthographic && !(depth_here > 0)) return Sight::unknown;
  const float pixel = footprint(float(depth_here));
  if (!(width > kResolved * pixel)) return Sight::unknown;
  const glm::dvec2 at = camera.project(own);
  const double left = std::floor(at.x - window.x0 - 0.5), top = std::floor(at.y - window.y0 - 0.5);
  const int w = surfel.width, h = surfel.height;
  if (!(top >= 0 && top + 1 < h)) return Sight::unknown;
  if (!closed && !(left >= 0 && left + 1 < w)) return Sight::unknown;
  const float gap = kSightGap * pixel;
  int beyond = 0, before = 0;
  for (int k = 0; k < 4; ++k) {
    const int x = (int(left) + k % 2 + w) % w, y = int(top) + k / 2;
    const float shown = depth(x, y);
    beyond += shown > float(depth_here) + gap;
    before += shown < float(depth_here) - gap;
  }
  if (before > 0) return Sight::unknown;
  return beyond == 4 ? Sight::empty : Sight::surface;
}

}  // namespace ssdo
