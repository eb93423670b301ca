// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/shot_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "jobs/messages.h"
#include "jobs/sequence/camera_steps.h"

namespace ssdo {
namespace {

/// Factor between the radius of the shot and that of a frame by itself from which on a line says
/// so: the mean of ao then changes by 0.01 to 0.08 on shots of three path-traced scenes.
constexpr float kOtherRadius = 1.5f;

/// Kinds of values that a line tells apart.
constexpr std::size_t kMostValues = 4;

/// The values of one thing, in the order in which they appear.
using Values = std::vector<std::pair<std::string, FramesByPlace>>;

void add_value(Values& values, const std::string& value, std::size_t place, int number) {
  auto at = std::ranges::find(values, value, &Values::value_type::first);
  if (at == values.end()) at = values.insert(at, {value, {}});
  at->second[place] = number;
}

/// "albedo: 'DiffCol' in frames 1 to 12, none in frames 13 to 24".
std::string line_of(const std::string& name, const Values& values) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < std::min(values.size(), kMostValues); ++i)
    parts.push_back(fmt::format("{} in {}", values[i].first, text_of(values[i].second)));
  if (values.size() > kMostValues)
    parts.push_back(fmt::format("{} others elsewhere", values.size() - kMostValues));
  return fmt::format("{}: {}", name, fmt::join(parts, ", "));
}

/// "0.41 to 0.55", or one of them where they are the same to these digits.
std::string range_of(float low, float high, std::string_view format) {
  const std::string a = fmt::format(fmt::runtime(format), low),
                    b = fmt::format(fmt::runtime(format), high);
  return a == b ? a : a + " to " + b;
}

/// A frame's camera; nothing where it has none in the world.
std::optional<CameraOfFrame> camera_of(const FrameTraits& traits) {
  if (!traits.world_known || !(traits.median_depth > 0)) return std::nullopt;
  return CameraOfFrame{traits.number, traits.camera, traits.display, traits.median_depth};
}

template <class Frames>
std::vector<CameraStep> steps_of(const Frames& frames) {
  std::vector<CameraOfFrame> cameras;
  for (const auto& frame : frames)
    if (const auto camera = camera_of(frame.traits)) cameras.push_back(*camera);
  return camera_steps(std::move(cameras));
}

/// "the camera jumps, as at a cut, from frame 12 to 13 and 29 to 30".
std::string jumps_in(const std::vector<CameraStep>& steps) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> jumps;
  double farthest = 0;
  for (const CameraStep& step : steps) {
    if (!step.jumps) continue;
    jumps.push_back(fmt::format("{} to {}", step.from, step.to));
    farthest = std::max(farthest, step.widths);
  }
  if (jumps.empty()) return "";
  const std::size_t more = jumps.size() - std::min(jumps.size(), kMost);
  jumps.resize(jumps.size() - more);
  return fmt::format(
      "the camera jumps, as at a cut, from frame {}{}: what it shows moves by {}{:.2f} of the "
      "picture's width",
      fmt::join(jumps, ", "), more > 0 ? fmt::format(" and {} more", more) : "",
      jumps.size() > 1 ? "up to " : "", farthest);
}

/// Frames that would have another radius by themselves.
template <class Frames>
std::string radius_of(const Frames& frames) {
  FramesByPlace other;
  float low = 0, high = 0, radius = 0;
  for (const auto& frame : frames) {
    const FrameTraits& traits = frame.traits;
    if (!traits.radius_alone || !(*traits.radius_alone > 0)) continue;
    const float alone = *traits.radius_alone;
    if (std::max(alone, traits.radius) <= kOtherRadius * std::min(alone, traits.radius)) continue;
    radius = traits.radius;
    low = other.empty() ? alone : std::min(low, alone);
    high = std::max(high, alone);
    other[frame.place] = traits.number;
  }
  if (other.empty()) return "";
  return fmt::format(
      "radius {:.4g} is that of the shot: for {} alone it would be {}; give --radius "
      "if it does not suit them",
      radius, text_of(other), range_of(low, high, "{:.4g}"));
}

/// How much is guessed, where that is much in one frame at least.
template <class Frames>
std::string guessed_in(const Frames& frames) {
  const auto share = [](const auto& frame) { return frame.traits.guessed.value_or(0); };
  const auto [least, most] = std::ranges::minmax_element(frames, {}, share);
  if (most->traits.remedy.empty()) return "";
  return fmt::format("{} of all directions are guessed{}; most in frame {}: {}",
                     range_of(share(*least), share(*most), "{:.2f}"),
                     most->traits.in_shot ? ", before the frames around say what they found" : "",
                     most->traits.number, most->traits.remedy);
}

}  // namespace

std::vector<std::string> ShotReport::add(std::size_t place, const FrameTraits& traits) {
  Frames& frames = views_[traits.view];
  std::vector<std::string> all, fresh;
  if (!frames.empty()) all = changes(frames.back().traits, traits);
  for (const std::string& change : all)
    if (told_.add(place, traits.number, traits.view + change)) fresh.push_back(change);
  frames.push_back({place, traits, std::move(all)});
  return fresh;
}

std::vector<std::string> ShotReport::differences(const Frames& frames) {
  std::vector<std::pair<std::string, Values>> things;
  for (const Noted& frame : frames) {
    for (const auto& [name, value] : frame.traits.properties()) {
      auto at = std::ranges::find(things, name, &decltype(things)::value_type::first);
      if (at == things.end()) at = things.insert(at, {name, {}});
      add_value(at->second, value, frame.place, frame.traits.number);
    }
  }
  std::vector<std::string> lines;
  for (const auto& [name, values] : things)
    if (values.size() > 1) lines.push_back(line_of(name, values));
  for (std::string line : {jumps_in(steps_of(frames)), radius_of(frames)})
    if (!line.empty()) lines.push_back(std::move(line));
  return lines;
}

std::vector<std::string> ShotReport::summary() const {
  std::vector<std::string> lines;
  for (const auto& [view, frames] : views_) {
    if (frames.size() < 2) continue;
    for (const std::string& line : differences(frames)) lines.push_back(warning_of(line, view));
    if (const std::string guessed = guessed_in(frames); !guessed.empty())
      lines.push_back(fmt::format("{}: {}", view.empty() ? "" : " (" + view + ")", guessed));
  }
  return lines;
}

void ShotReport::add_to(nlohmann::json& entries, const std::vector<std::string>& summary) const {
  using nlohmann::json;
  for (const auto& [view, frames] : views_) {
    const std::vector<CameraStep> steps = steps_of(frames);
    for (json& entry : entries) {
      if (entry["frame"].is_null() || entry["view"] != view) continue;
      const int number = entry["frame"];
      const auto noted =
          std::ranges::find(frames, number, [](const Noted& frame) { return frame.traits.number; });
      if (noted == frames.end()) continue;
      const auto step = std::ranges::find(steps, number, &CameraStep::to);
      json& shot = entry["shot"] = {
          {"changes", noted->changes}, {"camera_step", nullptr}, {"camera_jumps", false}};
      if (step != steps.end())
        shot["camera_step"] = step->widths, shot["camera_jumps"] = step->jumps;
      if (noted->traits.radius_alone) shot["radius_alone"] = *noted->traits.radius_alone;
      if (noted->traits.guessed) shot["guessed"] = *noted->traits.guessed;
    }
  }
  if (!entries.empty() && entries.back().contains("shot"))
    entries.back()["shot"]["summary"] = summary;
}

}  // namespace ssdo
