// SPDX-License-Identifier: Apache-2.0
#include "cli/sequence_frames.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "band_plan.h"
#include "cli/jobs.h"
#include "io/sequence.h"
#include "scene/camera/find_camera.h"

namespace ssdo {
namespace {

/// How far a frame is looked for whose P tells its camera.
constexpr int kMostFramesAway = 8;

/// None where the folder cannot be listed.
std::vector<int> frames_on_disk(const std::string& pattern) try {
  return find_frames(pattern);
} catch (const Error&) {
  return {};
}

}  // namespace

/// The surfaces of another frame; nothing where it cannot be read by itself.
std::optional<View> SequenceFrames::read(const FrameFiles& files) const try {
  std::error_code ignored;
  if (!std::filesystem::exists(files.input, ignored)) return std::nullopt;
  const std::vector<Role> unused = {Role::albedo,   Role::beauty,    Role::radiance, Role::ambient,
                                    Role::specular, Role::roughness, Role::motion};
  std::vector<LayerRequest> aovs = files.aovs;
  std::erase_if(aovs, [&](const LayerRequest& request) {
    return std::ranges::find(unused, request.role) != unused.end();
  });
  InputOptions input = for_view(options_.input, files);
  input.gbuffer.most_pixels = most_pixels_in(options_.memory);
  return read_view(open_view(files.input, aovs, input.allow_partial), aovs, input, options_.camera,
                   unused);
} catch (const Error&) {
  return std::nullopt;
}

std::optional<CameraBeside> SequenceFrames::camera_of(const FrameFiles& files) const {
  const std::optional<View> view = read(files);
  if (!view) return std::nullopt;
  const Placement& placement = view->report.placement;
  if (placement.of_positions.panorama || placement.median_depth <= 0) return std::nullopt;
  return CameraBeside{placement.of_positions, view->gbuffer.display_of_file(), files.input};
}

const std::vector<SequenceFrames::Evidence>& SequenceFrames::evidence(const std::string& name) {
  if (evidence_) return *evidence_;
  evidence_.emplace();
  const std::vector<int> frames = frames_on_disk(options_.input_file);
  if (frames.size() < 2) return *evidence_;
  for (const int number : std::set{frames.front(), frames[frames.size() / 2], frames.back()}) {
    const std::optional<View> view = read(in_view(files_at(options_, number), name));
    if (!view || view->report.placement.median_depth <= 0) continue;
    Evidence& found = evidence_->emplace_back();
    const GeometryReport& report = view->report;
    if (view->geometry.world_known) found.up = up_evidence(view->geometry);
    if (report.normal_agreement > 0 && report.normals_known)
      found.normal_space = report.normal_space, found.normal_agreement = report.normal_agreement;
  }
  return *evidence_;
}

/// The mean over frames, whose cameras are no independent witnesses.
std::optional<UpEvidence> SequenceFrames::up(const std::string& view) {
  UpEvidence mean{};
  double count = 0;
  for (const Evidence& frame : evidence(view)) {
    if (!frame.up) continue;
    count += 1;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += ((*frame.up)[i] - mean[i]) / count;
  }
  return count > 0 ? std::optional(mean) : std::nullopt;
}

/// What agrees best with P.
std::string SequenceFrames::normal_space(const std::string& view) {
  const auto& frames = evidence(view);
  const auto best = std::ranges::max_element(frames, {}, &Evidence::normal_agreement);
  return best == frames.end() ? "" : best->normal_space;
}

Frame SequenceFrames::prepare(const FrameOptions& options, const Lighting& light,
                              const FrameFiles& files, int number) try {
  return prepare_frame(options, light, pictures_, files, number);
} catch (const UndeterminedCamera&) {
  if (options.camera.shot.camera) throw;
  for (int i = 2; i < 2 * (kMostFramesAway + 1); ++i) {
    const std::int64_t other = std::int64_t(number) + (i % 2 == 0 ? -i / 2 : i / 2);
    if (std::int64_t(int(other)) != other) continue;
    FrameOptions with_camera = options;
    with_camera.camera.shot.camera = camera_of(in_view(files_at(options_, int(other)), files.view));
    if (!with_camera.camera.shot.camera) continue;
    try {
      return prepare_frame(with_camera, light, pictures_, files, number);
    } catch (const UndeterminedCamera&) {
      continue;  // its P lies elsewhere, as after a cut
    }
  }
  throw;
}

Frame SequenceFrames::prepare(const Lighting& light, const FrameFiles& files,
                              std::optional<int> number) {
  if (!number) return prepare_frame(options_, light, pictures_, files);
  FrameOptions options = options_;
  options.up_of_shot = [this, &files] { return up(files.view); };
  Frame frame = prepare(options, light, files, *number);
  if (frame.report.normals_known) return frame;
  options.camera.shot.normal_space = normal_space(files.view);
  if (frame.report.normal_space.starts_with(options.camera.shot.normal_space)) return frame;
  frame = Frame();
  return prepare(options, light, files, *number);
}

}  // namespace ssdo
