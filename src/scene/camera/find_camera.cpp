// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/find_camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <optional>
#include <string_view>

#include "error.h"
#include "scene/camera/fit.h"
#include "scene/camera/fit_pose.h"
#include "scene/camera/metadata/check.h"
#include "scene/camera/panorama.h"
#include "scene/camera/position_rounding.h"

namespace ssdo {
namespace {

/// The projection that the options give, without a pose unless it stands in a file.
std::optional<Camera> camera_from_options(const GBuffer& g, const CameraOptions& options,
                                          GeometryReport& report) {
  const Window& display = g.display_of_file();
  if (!options.file.empty()) {
    report.camera_source = "--camera " + options.file;
    return read_camera(options.file, display, g.pixel_aspect);
  }
  if (options.fov) {
    report.camera_source = fmt::format("--fov {:g}", *options.fov);
    return camera_from_fov(*options.fov, display, g.pixel_aspect);
  }
  if (options.ortho) {
    report.camera_source = fmt::format("--ortho {:g}", *options.ortho);
    return camera_from_ortho_width(*options.ortho, display, g.pixel_aspect);
  }
  return std::nullopt;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

/// What is unusable in the header: its poses, and its lenses too if P determines no camera.
std::vector<std::string> unused_of(const GBuffer& g, bool is_fitted) {
  std::vector<std::string> all = unusable_poses(g.header);
  if (is_fitted) return all;
  append(all, unusable_lenses(g.header));
  return all;
}

/// What the header says where it does not determine the camera, for messages.
std::string said_by(const std::vector<HeaderCamera>& header, const GBuffer& g) {
  if (g.by_blender) return " (Blender writes no camera; data/blender/export.py writes one)";
  const std::vector<std::string> unused = unused_of(g, false);
  if (!unused.empty()) return fmt::format(" ({})", unused.front());
  if (header.empty()) return "";
  const HeaderCamera& first = header.front();
  if (!first.contradiction.empty()) return fmt::format(" ({})", first.contradiction);
  return fmt::format(" ({} {})", describe(first),
                     !first.has_lens      ? "says nothing of the lens"
                     : g.position.empty() ? "does not fit the window and the shape of its pixels"
                                          : "does not put P on its own pixels");
}

[[noreturn]] void throw_undetermined(const GBuffer& g, const std::vector<HeaderCamera>& header,
                                     const std::string& file) {
  const auto message = [&](std::string_view what) {
    return fmt::format("{}: {}; give --fov DEGREES, --ortho WIDTH or --camera FILE.json{}", file,
                       what, said_by(header, g));
  };
  if (g.position.empty())
    throw Error(ExitCode::layer,
                message("has depth but no position, which leaves the camera open"));
  throw UndeterminedCamera(
      ExitCode::layer,
      message("the camera cannot be fitted from P, whose pixels lie in one plane or are too few"));
}

/// Pixels whose neighbours all show surfaces. Beside background, P may be an average with the
/// background, which does not project to its pixel.
Plane<unsigned char> inner_pixels(const Plane<unsigned char>& valid) {
  Plane<unsigned char> inner(valid.width, valid.height);
  for (int y = 1; y + 1 < valid.height; ++y) {
    for (int x = 1; x + 1 < valid.width; ++x) {
      inner(x, y) =
          valid(x, y) & valid(x - 1, y) & valid(x + 1, y) & valid(x, y - 1) & valid(x, y + 1);
    }
  }
  return inner;
}

/// P of a pinhole lands nearer to its pixels than this, but for rounding and filters.
constexpr double kPinholeMissPx = 0.05;

/// The camera from pixels that cannot be averages with the background, or else from all. Where a
/// pinhole explains P badly and none is `given`, it may be a panorama.
std::optional<Camera> fit_camera(const GBuffer& g, bool given) {
  const Plane<unsigned char> inner = inner_pixels(g.valid);
  auto fitted = ssdo::fit_camera(g.position, inner, g.window);
  if (!fitted) fitted = ssdo::fit_camera(g.position, g.valid, g.window);
  if (given) return fitted;
  const auto miss = [&](const Camera& camera) {
    return median_miss_px(camera, g.position, inner, g.window);
  };
  const double by_pinhole = fitted ? miss(*fitted) : INFINITY;
  if (by_pinhole < kPinholeMissPx) return fitted;
  const auto panorama = fit_panorama(g.position, inner, g.window, g.display);
  return panorama && miss(*panorama) < by_pinhole ? panorama : fitted;
}

/// The camera of --camera, if P projects to its own pixels under it, taken as world space with the
/// pose of the file, or as camera space.
std::optional<FoundCamera> pose_by_file(const GBuffer& g, const Camera& given,
                                        GeometryReport& report) {
  const double step = rounding_of_positions(g);
  if (explains(given, g.position, g.valid, g.window, step)) return FoundCamera{given, given, true};
  const auto in_camera_space = in_own_space(given, g.position, g.valid, g.window);
  if (!in_camera_space) return std::nullopt;
  report.camera_source += ", with P in camera space";
  return FoundCamera{given, *in_camera_space, true};
}

/// The camera of --fov or --ortho with the pose fitted from P.
std::optional<FoundCamera> pose_by_positions(const GBuffer& g, const Camera& given) {
  const auto posed = fit_pose(given, g.position, g.valid, g.window, rounding_of_positions(g));
  return posed ? std::optional(FoundCamera{*posed, *posed, false}) : std::nullopt;
}

/// The camera of another frame of the sequence, moved to where P projects to its own pixels.
std::optional<Camera> pose_beside(const GBuffer& g, const std::optional<NeighbourCamera>& beside,
                                  GeometryReport& report) {
  if (!beside || !(beside->display == g.display_of_file())) return std::nullopt;
  const auto posed = fit_pose_near(to_grid(beside->camera, g.grid), g.position, g.valid, g.window,
                                   rounding_of_positions(g));
  if (!posed) return std::nullopt;
  report.camera_source = fmt::format(
      "fitted from P with the lens of {}, and its pose where P leaves that open", beside->file);
  report.warnings.push_back(
      fmt::format("P does not tell the camera, which has the lens of {}, and the pose that is "
                  "nearest to that one's under which P fits",
                  beside->file));
  return posed;
}

/// What was found on a grid in the pixels of the file, with the projection of `given` if any.
FoundCamera on_file(FoundCamera found, const PixelGrid& grid, const Camera* given) {
  for (Camera* camera : {&found.camera, &found.position_camera}) {
    const Camera of_file = given ? *given : from_grid(*camera, grid);
    camera->fx = of_file.fx, camera->fy = of_file.fy;
    camera->cx = of_file.cx, camera->cy = of_file.cy;
  }
  return found;
}

/// The data window of a frame that is too large to be read at once is not known here.
PictureWindows windows_of(const GBuffer& g) {
  const Window &display = g.display_of_file(), data = g.lead_window.value_or(g.window);
  return {display, g.grid.is_coarse() ? display : data, double(g.pixel_aspect)};
}

/// The camera if options give a projection, which is `given` on the grid of the G-buffer.
FoundCamera find_under_options(const GBuffer& g, const Camera& given, const CameraOptions& options,
                               const std::string& file, GeometryReport& report, bool& is_fitted) {
  const bool by_file = !options.file.empty();
  const auto posed = by_file ? pose_by_file(g, given, report) : pose_by_positions(g, given);
  if (posed) return *posed;
  if (const auto fitted = fit_camera(g, true)) {
    report.warnings.push_back(
        fmt::format("{} contradicts P, whose own camera has {:.2f} degrees; P wins",
                    report.camera_source, fitted->hfov_degrees(g.display.width())));
    report.camera_source = "fitted from P";
    is_fitted = true;
    return {*fitted, *fitted, false};
  }
  if (by_file) return {given, given, true};
  if (const auto beside = pose_beside(g, options.shot.camera, report)) {
    is_fitted = true;
    return {*beside, *beside, false};
  }
  throw UndeterminedCamera(ExitCode::layer,
                           fmt::format("{}: P does not project to its own pixels under {}; "
                                       "give --camera FILE.json",
                                       file, report.camera_source));
}

/// The camera that P and the header tell.
FoundCamera find_without_options(const GBuffer& g, const std::vector<HeaderCamera>& header,
                                 const std::optional<NeighbourCamera>& beside,
                                 const std::string& file, GeometryReport& report) {
  if (const auto fitted = fit_camera(g, false)) {
    report.camera_source = "fitted from P";
    append(report.warnings, unused_of(g, true));
    return check_against_fit(*fitted, g, header, report);
  }
  if (const auto found = find_by_positions(g, header, report)) {
    append(report.warnings, unused_of(g, false));
    return *found;
  }
  if (const auto posed = pose_beside(g, beside, report)) {
    append(report.warnings, unused_of(g, true));
    return check_against_fit(*posed, g, header, report);
  }
  throw_undetermined(g, header, file);
}

}  // namespace

FoundCamera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report) {
  const auto given = camera_from_options(g, options, report);
  const std::vector<HeaderCamera> header = header_cameras(g.header, windows_of(g));
  if (g.position.empty()) {
    if (given) return {*given, *given, !options.file.empty()};
    const auto found = find_for_depth(g, header, report);
    if (!found) throw_undetermined(g, header, file);
    append(report.warnings, unused_of(g, false));
    return on_file(*found, g.grid, nullptr);
  }
  bool is_fitted = !given;
  const FoundCamera found =
      given ? find_under_options(g, to_grid(*given, g.grid), options, file, report, is_fitted)
            : find_without_options(g, header, options.shot.camera, file, report);
  report.residual = measure_residual(found.position_camera, g.position, g.valid, g.window);
  if (report.residual->median_px > 0.5) {
    report.warnings.push_back(
        fmt::format("camera ({}): half of the positions miss their pixels by {:.2g} px or more; "
                    "is this P of this camera?",
                    report.camera_source, report.residual->median_px));
  }
  return on_file(found, g.grid, is_fitted ? nullptr : &*given);
}

}  // namespace ssdo
