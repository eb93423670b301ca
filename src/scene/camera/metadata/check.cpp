// SPDX-License-Identifier: Apache-2.0
//
// P proves a camera, since P lands on its own pixels under no other. In camera space, P proves the
// lens alone, and a frame of depth alone proves nothing. Then the header has to agree with itself,
// and normals of the world, where there are any, decide later (normals/world_of_normals.cpp).
#include "scene/camera/metadata/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scene/camera/fit.h"
#include "scene/camera/fit_pose.h"
#include "scene/camera/position_rounding.h"
#include "scene/camera/projection_model.h"

namespace ssdo {
namespace {

Camera with_lens(Camera camera, const Camera& lens) {
  camera.orthographic = lens.orthographic;
  camera.fx = lens.fx, camera.fy = lens.fy, camera.cx = lens.cx, camera.cy = lens.cy;
  return camera;
}

/// Whether the axes of two poses differ by less than about 3 degrees; only then is one tested on P.
bool is_near(const Camera& a, const Camera& b) {
  for (int i = 0; i < 9; ++i) {
    if (!(std::abs(a.rotation[i / 3][i % 3] - b.rotation[i / 3][i % 3]) < 0.05)) return false;
  }
  return true;
}

bool explains(const Camera& camera, const GBuffer& g) {
  return explains(camera, g.position, g.valid, g.window, rounding_of_positions(g));
}

HeaderFinding found(const HeaderCamera& camera, HeaderProof proof) {
  return {camera.source, camera.reading, proof, std::nullopt};
}

/// The finding for a reading, with the median by which P misses its pixels under `proved`.
HeaderFinding found(const HeaderCamera& camera, HeaderProof proof, const Camera& proved,
                    const GBuffer& g) {
  const double miss = median_miss_px(proved, g.position, g.valid, g.window);
  return {camera.source, camera.reading, proof, g.grid.stride * miss};
}

/// `first` and, unless a second attribute confirms it, the other readings of its source.
std::vector<HeaderCamera> readings_from(const std::vector<HeaderCamera>& header,
                                        const HeaderCamera& first) {
  std::vector<HeaderCamera> readings = {first};
  for (const HeaderCamera& other : header) {
    const bool differs = other.reading != first.reading;
    if (!first.pose_agrees && other.source == first.source && differs) readings.push_back(other);
  }
  return readings;
}

/// The first reading under which P is in the world, with its own lens or with that of P.
std::optional<HeaderFinding> explained_by(const std::vector<HeaderCamera>& header,
                                          const Camera& fitted, const GBuffer& g) {
  for (const bool own_lens : {true, false}) {
    for (const HeaderCamera& h : header) {
      if (!h.has_pose || !is_near(h.camera, fitted) || (own_lens && !h.has_lens)) continue;
      const Camera camera = with_lens(h.camera, own_lens ? to_grid(h.camera, g.grid) : fitted);
      if (explains(camera, g)) return found(h, HeaderProof::positions, camera, g);
    }
  }
  return std::nullopt;
}

bool is_in_camera_space(const Camera& fitted, const GBuffer& g) {
  const Samples samples = collect_samples(g.position, g.valid, g.window);
  return fitted.is_camera_space(std::abs(fitted.to_camera(samples.centre).z));
}

void warn_of_contradiction(const HeaderCamera& camera, const std::string& what,
                           GeometryReport& report) {
  report.warnings.push_back(
      fmt::format("{} is not used: {}; the camera is that of P", describe(camera), what));
}

/// Whether a lens of the header may be a camera's: its principal point is in the picture, and its
/// pixels have the aspect ratio that the file gives.
bool is_plausible(const Camera& camera, const GBuffer& g) {
  const Window& display = g.display_of_file();
  const bool centred = camera.cx >= display.x0 && camera.cx <= display.x1 &&
                       camera.cy >= display.y0 && camera.cy <= display.y1;
  return centred && std::abs(camera.fy / camera.fx / double(g.pixel_aspect) - 1) < 0.01;
}

/// Whether there is overscan: from the renderer, or from tools that widen the data window and leave
/// the header as it was.
bool exceeds_display(const GBuffer& g) {
  const Window data = g.lead_window.value_or(g.window), &display = g.display;
  return data.x0 < display.x0 || data.y0 < display.y0 || data.x1 > display.x1 ||
         data.y1 > display.y1;
}

/// The camera of P in camera space, in the pose of a reading that has one.
FoundCamera posed(const HeaderCamera& h, const Camera& position_camera,
                  const std::vector<HeaderCamera>& header) {
  FoundCamera out{position_camera, position_camera, h.has_pose};
  if (!h.has_pose) return out;
  out.camera.rotation = h.camera.rotation, out.camera.origin = h.camera.origin;
  out.readings = readings_from(header, h);
  return out;
}

}  // namespace

std::string describe(const HeaderCamera& camera) {
  const std::string reading = camera.reading.empty() ? "" : " (" + camera.reading + ")";
  return "header " + camera.source + reading;
}

FoundCamera check_against_fit(const Camera& fitted, const GBuffer& g,
                              const std::vector<HeaderCamera>& header, GeometryReport& report) {
  const FoundCamera alone{fitted, fitted, false};
  const auto with_pose =
      std::find_if(header.begin(), header.end(), [](const HeaderCamera& h) { return h.has_pose; });
  if (with_pose == header.end() || fitted.panorama) return alone;
  const bool says_camera = g.space == Space::camera, says_world = g.space == Space::world;
  if (!says_camera) report.header = explained_by(header, fitted, g);
  if (report.header) return {fitted, fitted, true};
  const bool in_camera_space = is_in_camera_space(fitted, g);
  if (says_camera && !in_camera_space) return alone;
  if (says_world || !in_camera_space) {
    warn_of_contradiction(*with_pose, "under no reading of it does P land on its own pixels",
                          report);
    return alone;
  }
  if (!with_pose->contradiction.empty()) {
    warn_of_contradiction(*with_pose, with_pose->contradiction, report);
    return alone;
  }
  const auto holds_lens = [](const HeaderCamera& h) { return h.pose_agrees || h.is_one_matrix; };
  if (!holds_lens(*with_pose)) {
    report.header = found(*with_pose, HeaderProof::nothing);
    return posed(*with_pose, fitted, header);
  }
  for (const HeaderCamera& h : header) {
    if (!holds_lens(h)) continue;
    const auto own = in_own_space(to_grid(h.camera, g.grid), g.position, g.valid, g.window);
    if (!own) continue;
    report.header = found(h, HeaderProof::lens, *own, g);
    return posed(h, fitted, header);
  }
  warn_of_contradiction(*with_pose, "its lens is not that of P", report);
  return alone;
}

std::optional<FoundCamera> find_by_positions(const GBuffer& g,
                                             const std::vector<HeaderCamera>& header,
                                             GeometryReport& report) {
  for (const HeaderCamera& h : header) {
    if (!h.has_lens || !h.has_pose) continue;
    const Camera camera = to_grid(h.camera, g.grid);
    if (!explains(camera, g)) continue;
    report.header = found(h, HeaderProof::positions, camera, g);
    report.camera_source = describe(h);
    return FoundCamera{camera, camera, true};
  }
  for (const HeaderCamera& h : header) {
    if (!h.has_lens || !h.contradiction.empty() || !is_plausible(h.camera, g)) continue;
    const Camera lens = to_grid(h.camera, g.grid);
    if (const auto own = in_own_space(lens, g.position, g.valid, g.window)) {
      report.header = found(h, HeaderProof::lens, *own, g);
      report.camera_source = describe(h) + ", with P in camera space";
      return posed(h, *own, header);
    }
    if (h.has_pose) continue;
    const double step = rounding_of_positions(g);
    if (const auto fitted = fit_pose(lens, g.position, g.valid, g.window, step)) {
      report.header = found(h, HeaderProof::lens, *fitted, g);
      report.camera_source = describe(h);
      return posed(h, *fitted, header);
    }
  }
  return std::nullopt;
}

std::optional<FoundCamera> find_for_depth(const GBuffer& g, const std::vector<HeaderCamera>& header,
                                          GeometryReport& report) {
  const auto h = std::find_if(header.begin(), header.end(), [&](const HeaderCamera& camera) {
    return camera.has_lens && camera.contradiction.empty() && is_plausible(camera.camera, g);
  });
  if (h == header.end()) return std::nullopt;
  report.camera_source = describe(*h);
  report.header = found(*h, h->lens_agrees ? HeaderProof::consistency : HeaderProof::nothing);
  if (!h->lens_agrees) {
    report.warnings.push_back(
        fmt::format("{}: nothing proves that the lens has {:.4g} degrees{}; give --fov DEGREES or "
                    "--camera FILE.json to be sure",
                    describe(*h), h->camera.hfov_degrees(g.display_of_file().width()),
                    h->doubt.empty() ? "" : " (" + h->doubt + ")"));
  }
  if (exceeds_display(g)) {
    report.warnings.push_back(
        fmt::format("{}: its lens is that of the display window, unless the windows were changed "
                    "after the render: then give --fov DEGREES or --camera FILE.json",
                    describe(*h)));
  }
  return posed(*h, to_grid(h->camera, g.grid), header);
}

}  // namespace ssdo
