// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/sequence_frames.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <set>
#include <vector>

#include "io/sequence.h"
#include "jobs/jobs.h"
#include "plan/band_plan.h"
#include "plan/make_plan.h"
#include "relight/relight.h"
#include "scene/camera/find_camera.h"
#include "scene/objects/backdrop.h"

namespace ssdo {
namespace {

/// How many frames away a frame is looked for whose P tells its camera.
constexpr int kMostFramesAway = 8;

/// How many frames on disk tell the radius. Their median holds for most of a shot, whatever comes
/// close to the camera for a part of it.
constexpr std::size_t kFramesForRadius = 5;

/// The camera and samples of the surfaces tell which axis is up, and the median depth: an overview
/// of larger frames has enough of them.
constexpr std::size_t kEnoughForUp = 500000, kAllPixels = std::numeric_limits<std::size_t>::max();

/// None where the folder cannot be listed.
std::vector<int> frames_on_disk(const std::string& pattern) try {
  return find_frames(pattern);
} catch (const Error&) {
  return {};
}

}  // namespace

/// The surfaces of another frame; nothing where it cannot be read by itself.
std::optional<View> SequenceFrames::read(const FrameFiles& files, std::size_t most_pixels) const
    try {
  std::error_code ignored;
  if (!std::filesystem::exists(files.input, ignored)) return std::nullopt;
  const std::vector<Role> unused = {Role::albedo,    Role::beauty,         Role::radiance,
                                    Role::ambient,   Role::specular,       Role::light,
                                    Role::roughness, Role::specular_color, Role::motion};
  std::vector<LayerRequest> aovs = files.aovs;
  std::erase_if(aovs, [&](const LayerRequest& request) {
    return std::ranges::find(unused, request.role) != unused.end();
  });
  InputOptions input = for_view(options_.input, files);
  input.gbuffer.most_pixels =
      std::min(most_pixels, most_pixels_in(options_.memory, options_.output, 0));
  return read_view(open_view(files.input, aovs, input.allow_partial), aovs, input, options_.camera,
                   unused);
} catch (const Error&) {
  return std::nullopt;
}

std::optional<NeighbourCamera> SequenceFrames::camera_of(const FrameFiles& files) const {
  const std::optional<View> view = read(files, kAllPixels);
  if (!view) return std::nullopt;
  const Placement& placement = view->report.placement;
  if (placement.position_camera.panorama || placement.median_depth <= 0) return std::nullopt;
  return NeighbourCamera{placement.position_camera, view->gbuffer.display_of_file(), files.input};
}

/// Calls `at` for those of `count` frames on disk, spread evenly over the shot from its first to
/// its last, that show surfaces; `of_three` holds for the first, the middle and the last.
void SequenceFrames::look(const std::string& name, std::size_t most_pixels,
                          const std::function<void(const View&, bool of_three)>& at,
                          std::size_t count) const {
  const std::vector<int> frames = frames_on_disk(options_.input_file);
  if (frames.size() < 2) return;
  const auto spread = [&](std::size_t parts) {
    std::set<int> chosen;
    for (std::size_t i = 0; i < parts; ++i)
      chosen.insert(frames[std::min(i * frames.size() / (parts - 1), frames.size() - 1)]);
    return chosen;
  };
  const std::set<int> three = spread(kThree);
  for (const int number : spread(count)) {
    const auto view = read(in_view(files_at(options_, number), name), most_pixels);
    if (view && view->report.placement.median_depth > 0) at(*view, three.contains(number));
  }
}

/// What frames on disk tell; each is read once for all that is asked.
const std::vector<SequenceFrames::ShotClues>& SequenceFrames::clues(const std::string& name) {
  const auto [at, is_new] = clues_.try_emplace(name);
  std::vector<ShotClues>& all = at->second;
  if (!is_new) return all;
  const auto note = [&](const View& view, bool of_three) {
    const Geometry& geometry = view.geometry;
    ShotClues& clue = all.emplace_back(ShotClues{of_three, {}, {}, radius_by_frame(geometry)});
    if (!of_three) return;
    if (geometry.world_known) clue.up = up_evidence(geometry);
    if (const auto found = find_backdrop(geometry)) clue.clearance = found->clearance;
  };
  look(name, kEnoughForUp, note, finds_radius(options_.model) ? kFramesForRadius : kThree);
  return all;
}

/// The mean evidence over frames, not the sum: their cameras are no independent witnesses.
std::optional<UpEvidence> SequenceFrames::up(const std::string& name) {
  if (up_) return *up_;
  UpEvidence mean{};
  double count = 0;
  for (const ShotClues& frame : clues(name)) {
    if (!frame.up) continue;
    count += 1;
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += ((*frame.up)[i] - mean[i]) / count;
  }
  return up_.emplace(count > 0 ? std::optional(mean) : std::nullopt);
}

/// The geometric mean of the clearance over frames that show the backdrop's shape.
std::optional<double> SequenceFrames::backdrop(const std::string& name) {
  if (backdrop_) return *backdrop_;
  double sum = 0, count = 0;
  for (const ShotClues& frame : clues(name))
    if (frame.clearance) sum += std::log(*frame.clearance), count += 1;
  return backdrop_.emplace(count > 0 ? std::optional(std::exp(sum / count)) : std::nullopt);
}

/// The space of N in the frame whose N agrees best with P.
std::string SequenceFrames::normal_space(const std::string& name) {
  if (normal_space_) return *normal_space_;
  double best = 0;
  normal_space_.emplace();
  look(name, kAllPixels, [&](const View& view, bool) {
    const GeometryReport& report = view.report;
    if (!report.normals_known || report.normal_agreement <= best) return;
    best = report.normal_agreement, normal_space_ = report.normal_space;
  });
  return *normal_space_;
}

/// The median radius; of an even number, the two in the middle are averaged.
std::optional<float> SequenceFrames::radius(const std::string& name) {
  if (!finds_radius(options_.model)) return std::nullopt;
  const auto [at, is_new] = radius_.try_emplace(name);
  if (!is_new) return at->second;
  std::vector<float> found;
  for (const ShotClues& frame : clues(name)) found.push_back(frame.radius);
  std::ranges::sort(found);
  const std::size_t half = found.size() / 2;
  if (!found.empty())
    at->second = found.size() % 2 == 1 ? found[half] : (found[half - 1] + found[half]) / 2;
  return at->second;
}

Frame SequenceFrames::prepare(const FrameOptions& options, const Lighting& light,
                              const FrameFiles& files, int number) try {
  return prepare_frame(options, light, pictures_, files, number);
} catch (const UndeterminedCamera&) {
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
  options.model.radius_of_shot = radius(files.view);
  options.backdrop_of_shot = [this, &files] { return backdrop(files.view); };
  Frame frame = prepare(options, light, files, *number);
  if (frame.report.normals_known) return frame;
  options.camera.shot.normal_space = normal_space(files.view);
  if (frame.report.normal_space.starts_with(options.camera.shot.normal_space)) return frame;
  frame = Frame();
  return prepare(options, light, files, *number);
}

}  // namespace ssdo
