// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "error.h"
#include "parallel/tiles.h"
#include "scene/camera_fit.h"
#include "scene/normals.h"
#include "scene/silhouettes.h"

namespace ssdo {
namespace {

/// The projection that the options give, without a pose unless it stands in a file.
std::optional<Camera> camera_from_options(const GBuffer& g, const CameraOptions& options,
                                          GeometryReport& report) {
  if (!options.file.empty()) {
    report.camera_source = "--camera " + options.file;
    return read_camera(options.file, g.display, g.pixel_aspect);
  }
  if (options.fov) {
    report.camera_source = fmt::format("--fov {:g}", *options.fov);
    return camera_from_fov(*options.fov, g.display, g.pixel_aspect);
  }
  if (options.ortho) {
    report.camera_source = fmt::format("--ortho {:g}", *options.ortho);
    return camera_from_ortho_width(*options.ortho, g.display, g.pixel_aspect);
  }
  return std::nullopt;
}

[[noreturn]] void throw_undetermined(const GBuffer& g, const std::string& file) {
  throw Error(
      ExitCode::layer,
      g.position.empty()
          ? fmt::format("{}: has depth but no position, which leaves the camera open; give "
                        "--fov DEGREES, --ortho WIDTH or --camera FILE.json",
                        file)
          : fmt::format("{}: the camera cannot be fitted from P, whose pixels lie in one "
                        "plane or are too few; give --fov DEGREES, --ortho WIDTH or --camera "
                        "FILE.json",
                        file));
}

/// Pixels whose neighbours all show something: at the edge of what a frame shows, P may be an
/// average with the background, far from where its pixel looks.
Plane<unsigned char> inner_pixels(const Plane<unsigned char>& valid) {
  Plane<unsigned char> inner(valid.width, valid.height);
  for (int y = 1; y + 1 < valid.height; ++y) {
    for (int x = 1; x + 1 < valid.width; ++x) {
      inner(x, y) =
          valid(x, y) && valid(x - 1, y) && valid(x + 1, y) && valid(x, y - 1) && valid(x, y + 1);
    }
  }
  return inner;
}

/// The camera by pixels that are surely no averages, or else by all.
std::optional<Camera> fit_camera(const GBuffer& g) {
  const auto fitted = ssdo::fit_camera(g.position, inner_pixels(g.valid), g.window);
  return fitted ? fitted : ssdo::fit_camera(g.position, g.valid, g.window);
}

/// The most by which storing P may have moved it along one axis, in scene units.
double rounding_of_positions(const GBuffer& g) {
  float largest = 0;
  for (std::size_t i = 0; i < g.position.size(); ++i) {
    if (!g.valid[i]) continue;
    const glm::vec3 p = glm::abs(g.position[i]);
    largest = std::max({largest, p.x, p.y, p.z});
  }
  return double(largest) * g.position_step;
}

Camera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                   GeometryReport& report) {
  const auto given = camera_from_options(g, options, report);
  if (g.position.empty()) {
    if (!given) throw_undetermined(g, file);
    return *given;
  }
  Camera camera;
  if (given && !options.file.empty()) {
    camera = *given;
  } else if (given) {
    const auto posed = fit_pose(*given, g.position, g.valid, g.window, rounding_of_positions(g));
    const auto fitted = posed ? posed : fit_camera(g);
    if (!fitted) {
      throw Error(ExitCode::layer, fmt::format("{}: P does not project to its own pixels under {}; "
                                               "give --camera FILE.json",
                                               file, report.camera_source));
    }
    if (!posed) {
      report.warnings.push_back(fmt::format("{} contradicts P, which shows {:.2f} degrees; P wins",
                                            report.camera_source,
                                            fitted->hfov_degrees(g.display.width())));
      report.camera_source = "fitted from P";
    }
    camera = *fitted;
  } else {
    const auto fitted = fit_camera(g);
    if (!fitted) throw_undetermined(g, file);
    report.camera_source = "fitted from P";
    camera = *fitted;
  }
  report.residual = measure_residual(camera, g.position, g.valid, g.window);
  if (report.residual->median_px > 0.5) {
    report.warnings.push_back(
        fmt::format("camera ({}): half of the positions miss their pixels by {:.2g} px or more; "
                    "is this P of this camera?",
                    report.camera_source, report.residual->median_px));
  }
  return camera;
}

/// Camera-space positions, and the radius by which rounding may have moved each of them.
void place_positions(const GBuffer& g, Geometry& out) {
  const Camera& camera = out.camera;
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
      out.surfel[i].position = glm::vec4(glm::vec3(p), 1.0f);
      out.surfel[i].normal.w = float(magnitude) * g.position_step;
    }
  });
}

void drop_pixels_behind_camera(Geometry& out, GeometryReport& report) {
  std::size_t behind = 0;
  for (Surfel& s : out.surfel.pixels) {
    if (s.position.w == 0 || s.position.z < 0) continue;
    s = {};
    ++behind;
  }
  if (behind > 0) {
    report.warnings.push_back(
        fmt::format("{} positions lie behind the camera and are left out", behind));
  }
}

/// Least median cosine between N and the gradient of P. Stored normals are better than those of a
/// rough P, so little is asked; but where P was made from depth, no rotation to a world is known,
/// and normals of a world that is tilted against the camera must not pass.
constexpr double kAgreementOfP = 0.3, kAgreementOfDepth = 0.9;

void place_normals(const GBuffer& g, Geometry& out, GeometryReport& report) {
  const bool orthographic = out.camera.orthographic;
  NormalSpace space{glm::mat3(1), "rebuilt from P", 0};
  if (!g.normal.empty()) {
    space = find_normal_space(g.normal, out.surfel, glm::mat3(out.camera.rotation), orthographic);
    if (space.agreement < (g.position.empty() ? kAgreementOfDepth : kAgreementOfP)) {
      report.warnings.push_back(
          fmt::format("normals do not belong to P (median cosine {:.2f} at "
                      "best); rebuilt from P",
                      space.agreement));
      space.name = "rebuilt from P";
    }
  }
  const bool rebuild_all = space.name == "rebuilt from P";
  out.normals_to_camera = rebuild_all ? glm::mat3(out.camera.rotation) : space.to_camera;
  report.normal_space = space.name;
  report.normal_agreement = space.agreement;

  Plane<unsigned char> fate(out.surfel.width, out.surfel.height);  // 1 rebuilt, 2 turned
  for_each_row(out.surfel.height, [&](int y) {
    for (int x = 0; x < out.surfel.width; ++x) {
      const std::size_t i = out.surfel.index(x, y);
      if (!out.is_surface(i)) continue;
      const glm::vec3 view = direction_to_viewer(glm::vec3(out.surfel[i].position), orthographic);
      glm::vec3 n = rebuild_all ? glm::vec3(0) : space.to_camera * g.normal[i];
      const float length = glm::length(n);
      if (length > 1e-4f && length < 1e4f) {
        n /= length;
        // A smooth normal may lean away from the viewer at a silhouette; one that is opposite to
        // what P shows is the back of the surface.
        if (glm::dot(n, view) < 0 && glm::dot(n, gradient_normal(out.surfel, x, y, view)) < 0) {
          n = -n;
          fate[i] = 2;
        }
      } else {
        n = gradient_normal(out.surfel, x, y, view);
        if (n == glm::vec3(0)) n = view;
        fate[i] = 1;
      }
      out.surfel[i].normal = glm::vec4(n, out.surfel[i].normal.w);
    }
  });
  for (unsigned char f : fate.pixels) {
    report.normals_rebuilt += f == 1;
    report.normals_turned += f == 2;
  }
}

float median_depth(const Geometry& geometry) {
  std::vector<float> depths;
  for (const Surfel& s : geometry.surfel.pixels) {
    if (s.position.w != 0) depths.push_back(-s.position.z);
  }
  if (depths.empty()) return 0;
  const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

}  // namespace

float Geometry::frame_height_at(float depth) const {
  return float(display.height() / camera.fy * (camera.orthographic ? 1.0 : depth));
}

Geometry build_geometry(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report) {
  Geometry out;
  out.window = g.window;
  out.display = g.display;
  out.surfel = Plane<Surfel>(g.window.width(), g.window.height());
  if (g.background_pixels + g.bad_pixels >= g.valid.size() &&
      std::none_of(g.valid.pixels.begin(), g.valid.pixels.end(), [](auto v) { return v != 0; })) {
    report.camera_source = "none: the frame shows no surface";
    report.warnings.push_back("the frame shows no surface");
    return out;
  }
  out.camera = find_camera(g, options, file, report);
  place_positions(g, out);
  drop_pixels_behind_camera(out, report);
  place_normals(g, out, report);
  if (report.residual) {
    const std::size_t averages = mend_silhouettes(out, *report.residual);
    if (averages > 0) {
      report.warnings.push_back(fmt::format(
          "P is an average over an edge in {} pixels, which take the surface beside them; export P "
          "and N without a filter",
          averages));
    }
  }
  out.median_depth = median_depth(out);
  const bool posed_by_file = !options.file.empty();
  out.world_known =
      posed_by_file || (!g.position.empty() && !out.camera.is_camera_space(out.median_depth));
  if (out.world_known) out.world_to_camera = glm::mat3(out.camera.rotation);
  return out;
}

}  // namespace ssdo
