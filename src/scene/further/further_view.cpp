// SPDX-License-Identifier: Apache-2.0
#include "scene/further/further_view.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "error.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

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

}  // namespace ssdo
