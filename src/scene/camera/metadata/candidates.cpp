// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/metadata/candidates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <optional>
#include <string_view>

#include "scene/camera/metadata/matrices.h"
#include "scene/camera/metadata/unreal.h"

namespace ssdo {
namespace {

using Header = std::map<std::string, std::vector<double>>;

/// The attributes of one renderer. The aperture is that of the film's width, in the unit of the
/// focal length; the field of view is horizontal, in degrees.
struct RendererRow {
  std::string_view pose;
  PoseConvention convention;
  std::string_view fov, focal_length, aperture;
};

constexpr RendererRow kStandard = {"worldToCamera",
                                   {PoseDirection::to_camera, CameraAxes::along_z},
                                   "",
                                   "CameraFocalLength",
                                   "CameraFilmApertureHorizontal"};
constexpr RendererRow kVRay = {"cameraTransform",
                               {PoseDirection::to_world, CameraAxes::along_minus_y_z_down},
                               "cameraFov",
                               "cameraFocalLength",
                               "cameraAperture"};
constexpr RendererRow kRedshift = {"rs/camera/transform",
                                   {PoseDirection::to_world, CameraAxes::along_z_x_left},
                                   "rs/camera/fov",
                                   "",
                                   ""};

std::optional<double> number(const Header& header, std::string_view name) {
  const auto found = header.find(std::string(name));
  if (found == header.end() || found->second.size() == 16) return std::nullopt;
  return found->second.front();
}

std::optional<StoredMatrix> matrix(const Header& header, std::string_view name) {
  const auto found = header.find(std::string(name));
  if (found == header.end() || found->second.size() != 16) return std::nullopt;
  StoredMatrix stored;
  std::copy(found->second.begin(), found->second.end(), stored.begin());
  return stored;
}

/// What single numbers say of the lens.
struct Lens {
  std::string source, doubt;
  double fov = 0;  ///< degrees; 0: nothing
  bool agrees = false;
};

/// Fields of view closer than this are the same: apertures are stored with few digits.
constexpr double kSameFov = 0.005;

/// A field of view, and the attributes that say it.
struct Fov {
  std::string source;
  double degrees;
};

/// The limits of a field of view in degrees, as for --fov.
constexpr double kLeastFov = 0.01, kMostFov = 179;

bool is_lens(const Fov& fov) { return fov.degrees >= kLeastFov && fov.degrees <= kMostFov; }

/// The fields of view by the attributes of a row: the stored one, then that of its film.
std::vector<Fov> fovs_of(const Header& header, const RendererRow& row) {
  const auto fov = number(header, row.fov), focal = number(header, row.focal_length),
             aperture = number(header, row.aperture);
  std::vector<Fov> all;
  if (fov) all.push_back({std::string(row.fov), *fov});
  if (focal && aperture && *focal > 0 && *aperture > 0)
    all.push_back({fmt::format("{} + {}", row.focal_length, row.aperture),
                   glm::degrees(2 * std::atan(0.5 * *aperture / *focal))});
  return all;
}

Lens lens_of(const Header& header, const RendererRow& row) {
  std::vector<Fov> fovs = fovs_of(header, row);
  std::erase_if(fovs, [](const Fov& fov) { return !is_lens(fov); });
  if (fovs.empty()) return {};
  const Fov &first = fovs.front(), &last = fovs.back();
  Lens lens{first.source, "", first.degrees};
  if (fovs.size() == 1) return lens;
  lens.agrees = std::abs(last.degrees - first.degrees) < kSameFov * first.degrees;
  if (!lens.agrees)
    lens.doubt = fmt::format("{} is {:.4g} degrees, {} mean {:.4g}", first.source, first.degrees,
                             last.source, last.degrees);
  return lens;
}

void set_lens(HeaderCamera& out, const Lens& lens, const PictureWindows& windows) {
  if (lens.fov == 0) return;
  const Camera projection = camera_from_fov(lens.fov, windows.display, windows.pixel_aspect);
  out.camera.fx = projection.fx, out.camera.fy = projection.fy;
  out.camera.cx = projection.cx, out.camera.cy = projection.cy;
  out.has_lens = true, out.lens_agrees = lens.agrees, out.doubt = lens.doubt;
  out.source += (out.source.empty() ? "" : " + ") + lens.source;
}

std::string joined(const std::string& a, std::string_view b) {
  return a + (a.empty() || b.empty() ? "" : ", ") + std::string(b);
}

/// The readings of worldToCamera and worldToNDC under which they are one camera.
std::vector<HeaderCamera> of_pair(const std::vector<PoseReading>& poses, const StoredMatrix& to_ndc,
                                  const PictureWindows& windows) {
  std::vector<HeaderCamera> all;
  for (const PoseReading& pose : poses) {
    for (const NdcWindow ndc : kNdcWindows) {
      auto camera = read_perspective(to_ndc, pose.transposed, ndc, windows);
      if (camera && !same_pose(*camera, pose)) continue;
      if (!camera) camera = read_orthographic(to_ndc, pose, ndc, windows);
      if (!camera) continue;
      camera->rotation = pose.rotation, camera->origin = pose.origin;
      all.push_back({"worldToCamera + worldToNDC", joined(pose.how, name_of(ndc)), *camera, true,
                     true, true, true});
    }
  }
  return all;
}

std::vector<HeaderCamera> of_ndc_alone(const StoredMatrix& to_ndc, const PictureWindows& windows) {
  std::vector<HeaderCamera> all;
  for (const bool transposed : {false, true}) {
    for (const NdcWindow ndc : kNdcWindows) {
      const auto camera = read_perspective(to_ndc, transposed, ndc, windows);
      if (!camera) continue;
      HeaderCamera& out = all.emplace_back();
      out.source = "worldToNDC";
      out.reading = joined(transposed ? "transposed" : "", name_of(ndc));
      out.camera = turned_to_picture(*camera, to_ndc, transposed);
      out.has_pose = out.has_lens = out.is_one_matrix = true;
    }
  }
  return all;
}

/// The readings of a matrix, each with the lens of single numbers; of a header without the matrix,
/// the lens alone.
std::vector<HeaderCamera> of_renderer(const Header& header, const RendererRow& row,
                                      const PictureWindows& windows) {
  const Lens lens = lens_of(header, row);
  const auto stored = matrix(header, row.pose);
  std::vector<HeaderCamera> all;
  for (const PoseReading& pose :
       stored ? read_pose(*stored, row.convention) : std::vector<PoseReading>()) {
    HeaderCamera& out = all.emplace_back();
    out.source = row.pose, out.reading = pose.how, out.has_pose = true;
    out.camera.rotation = pose.rotation, out.camera.origin = pose.origin;
    set_lens(out, lens, windows);
  }
  if (all.empty() && lens.fov > 0) set_lens(all.emplace_back(), lens, windows);
  return all;
}

void append(std::vector<HeaderCamera>& all, const std::vector<HeaderCamera>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

std::vector<HeaderCamera> of_standard(const Header& header, const PictureWindows& windows) {
  const auto to_camera = matrix(header, kStandard.pose), to_ndc = matrix(header, "worldToNDC");
  std::vector<HeaderCamera> all;
  if (to_camera && to_ndc)
    all = of_pair(read_pose(*to_camera, kStandard.convention), *to_ndc, windows);
  const bool contradict = to_camera && to_ndc && all.empty();
  if (to_ndc && all.empty()) append(all, of_ndc_alone(*to_ndc, windows));
  append(all, of_renderer(header, kStandard, windows));
  if (contradict) {
    for (HeaderCamera& camera : all)
      camera.contradiction = "worldToCamera and worldToNDC are not of one camera";
  }
  return all;
}

/// Whether worldToCamera is V-Ray's cameraTransform, a matrix to the world, which OpenImageIO reads
/// and writes under this name: V-Ray's other attributes are there, and worldToNDC is not.
bool is_renamed_by_oiio(const Header& header) {
  return header.contains("worldToCamera") && !header.contains("worldToNDC") &&
         !header.contains("cameraTransform") && header.contains("cameraFov");
}

/// The header without V-Ray's lens if the projection is not that of a pinhole: the numbers then
/// mean something else.
Header of_pinholes(Header header) {
  if (number(header, "cameraProjection").value_or(0) != 0) {
    for (const std::string_view name : {kVRay.fov, kVRay.focal_length, kVRay.aperture})
      header.erase(std::string(name));
  }
  return header;
}

std::vector<HeaderCamera> of_vray(const Header& header, const PictureWindows& windows) {
  const Header pinhole = of_pinholes(header);
  if (!is_renamed_by_oiio(header)) return of_renderer(pinhole, kVRay, windows);
  RendererRow renamed = kVRay;
  renamed.pose = "worldToCamera";
  std::vector<HeaderCamera> all = of_renderer(pinhole, renamed, windows);
  for (HeaderCamera& camera : all)
    camera.reading = joined("V-Ray's cameraTransform, renamed by OpenImageIO", camera.reading);
  return all;
}

/// The first number of Unreal's under `prefix` whose name ends so.
std::optional<double> number_of_unreal(const Header& header, const std::string& prefix,
                                       std::string_view ending) {
  for (auto it = header.lower_bound(prefix); it != header.end() && it->first.starts_with(prefix);
       ++it) {
    if (it->first.ends_with(ending)) return number(header, it->first);
  }
  return std::nullopt;
}

/// Unreal writes strings, under unreal/camera/ or, newer, under a folder for each layer or camera.
std::vector<HeaderCamera> of_unreal(const Header& header, const PictureWindows& windows) {
  constexpr std::string_view kX = "curPos/x";
  std::vector<HeaderCamera> all;
  for (const auto& [name, value] : header) {
    if (!name.starts_with("unreal/") || !name.ends_with(kX)) continue;
    const std::string prefix = name.substr(0, name.size() - kX.size());
    const auto at = [&](const char* of) { return number(header, prefix + of); };
    const auto x = at("curPos/x"), y = at("curPos/y"), z = at("curPos/z"),
               pitch = at("curRot/pitch"), yaw = at("curRot/yaw"), roll = at("curRot/roll");
    if (!x || !y || !z || !pitch || !yaw || !roll) continue;
    HeaderCamera& out = all.emplace_back();
    out.source = prefix + "curPos + curRot", out.has_pose = true;
    out.camera.rotation = rotation_of(UnrealRotation{*pitch, *yaw, *roll});
    out.camera.origin = {*x, *y, *z};
    Header numbers;
    for (const char* of : {"fov", "focalLength", "sensorWidth"}) {
      const auto found = number_of_unreal(header, prefix, "/" + std::string(of));
      if (found) numbers[of] = {*found};
    }
    const RendererRow row{"", {}, "fov", "focalLength", "sensorWidth"};
    set_lens(out, lens_of(numbers, row), windows);
  }
  return all;
}

}  // namespace

std::vector<HeaderCamera> header_cameras(const Header& header, const PictureWindows& windows) {
  std::vector<HeaderCamera> all;
  if (!is_renamed_by_oiio(header)) append(all, of_standard(header, windows));
  append(all, of_vray(header, windows));
  append(all, of_renderer(header, kRedshift, windows));
  append(all, of_unreal(header, windows));
  return all;
}

std::vector<std::string> unusable_poses(const Header& header) {
  std::vector<std::string> all;
  for (const RendererRow& row : {kStandard, kVRay, kRedshift}) {
    const auto stored = matrix(header, row.pose);
    if (stored && read_pose(*stored, row.convention).empty())
      all.push_back(
          fmt::format("header {} is no rotation and translation, and is not used", row.pose));
  }
  return all;
}

std::vector<std::string> unusable_lenses(const Header& header) {
  std::vector<Fov> fovs;
  for (const RendererRow& row : {kStandard, kVRay, kRedshift}) {
    for (const Fov& fov : fovs_of(of_pinholes(header), row)) fovs.push_back(fov);
  }
  for (const auto& [name, value] : header) {
    if (name.starts_with("unreal/") && name.ends_with("/fov"))
      fovs.push_back({name, value.front()});
  }
  std::vector<std::string> all;
  for (const Fov& fov : fovs) {
    if (!is_lens(fov))
      all.push_back(fmt::format("header {} is {:g} degrees, outside {:g} to {:g}, and is not used",
                                fov.source, fov.degrees, kLeastFov, kMostFov));
  }
  return all;
}

}  // namespace ssdo
