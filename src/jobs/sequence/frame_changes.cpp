// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/frame_changes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "error.h"

namespace ssdo {

namespace {

/// Without what differs from frame to frame: how far normals agree, and by how much a space is
/// turned.
std::string normal_space_of(const Frame& frame) {
  if (!frame.layers[Role::normal] || !frame.report.placement.normals_to_camera) return "";
  const std::string& name = frame.report.normal_space;
  if (name.starts_with("a space of its own")) return "a space of its own";
  for (const std::string_view end : {", unchecked", ", rebuilt", ", by"})
    if (const auto at = name.find(end); at != name.npos) return name.substr(0, at);
  return name;
}

std::string_view type_of(bool half) { return half ? "half" : "float"; }

}  // namespace

FrameTraits traits_of(const Frame& frame, const FrameFiles& files, int number) {
  const Window& display = frame.part().display_window;
  const Geometry& geometry = frame.scene.geometry;
  FrameTraits traits;
  traits.number = number;
  traits.view = frame.view;
  traits.width = display.width(), traits.height = display.height();
  traits.normal_space = normal_space_of(frame);
  if (frame.layers[Role::depth]) {
    traits.depth_kind = frame.gbuffer.encodings.depth_is_wrong       ? "left out"
                        : frame.gbuffer.depth_kind == DepthKind::ray ? "ray"
                                                                     : "planar";
  }
  // A frame without surfaces has no use for views, whether they fit or not.
  if (frame.report.placement.median_depth > 0) traits.also = files.also;
  for (const std::string& file : traits.also)
    traits.fits.push_back(std::ranges::find(frame.views, file, &MergeCounts::file) !=
                          frame.views.end());
  for (std::size_t i = 0; i < kRoleCount; ++i)
    if (const auto& layer = frame.layers.layers[i])
      traits.layers[i] = layer->name, traits.half[i] = layer->half;
  traits.camera = geometry.camera;
  traits.display = geometry.display;
  traits.median_depth = geometry.median_depth;
  traits.world_known = geometry.world_known;
  traits.radius = frame.plan.request.radius;
  traits.radius_alone = frame.plan.radius_alone;
  traits.guessed = frame.guessed.share;
  traits.in_shot = frame.plan.shot;
  traits.remedy = frame.guessed.remedy;
  return traits;
}

std::vector<std::pair<std::string, std::string>> FrameTraits::properties() const {
  std::vector<std::pair<std::string, std::string>> found;
  for (std::size_t i = 0; i < kRoleCount; ++i)
    found.emplace_back(
        role_name(Role(i)),
        layers[i].empty() ? "none" : fmt::format("'{}' ({})", layers[i], type_of(half[i])));
  found.emplace_back("size", fmt::format("{} x {}", width, height));
  if (!normal_space.empty()) found.emplace_back("space of normals", normal_space);
  if (!depth_kind.empty()) found.emplace_back("kind of depth", depth_kind);
  for (std::size_t i = 0; i < also.size(); ++i)
    found.emplace_back("--also " + also[i], fits[i] ? "used" : "left out");
  return found;
}

std::vector<std::string> changes(const FrameTraits& before, const FrameTraits& now) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    const std::string &old = before.layers[i], &own = now.layers[i];
    const std::string_view role = role_name(Role(i));
    if (old == own) {
      if (before.half[i] != now.half[i])
        lines.push_back(fmt::format("{} is of another type: {} in frame {}, {} in frame {}", role,
                                    type_of(before.half[i]), before.number, type_of(now.half[i]),
                                    now.number));
      continue;
    }
    lines.push_back(
        own.empty()   ? fmt::format("{} is gone: frame {} has it in '{}', frame {} has none", role,
                                    before.number, old, now.number)
        : old.empty() ? fmt::format("{} is new: frame {} has none, frame {} has it in '{}'", role,
                                    before.number, now.number, own)
                      : fmt::format("{} is another layer: '{}' in frame {}, '{}' in frame {}", role,
                                    old, before.number, own, now.number));
  }
  if (before.width != now.width || before.height != now.height) {
    lines.push_back(fmt::format("the size changes: frame {} has {} x {} pixels, frame {} {} x {}",
                                before.number, before.width, before.height, now.number, now.width,
                                now.height));
  }
  if (!before.normal_space.empty() && !now.normal_space.empty() &&
      before.normal_space != now.normal_space) {
    lines.push_back(fmt::format("normals are of another space: {} in frame {}, {} in frame {}",
                                before.normal_space, before.number, now.normal_space, now.number));
  }
  for (std::size_t i = 0; i < std::min(before.fits.size(), now.fits.size()); ++i) {
    if (before.fits[i] == now.fits[i]) continue;
    lines.push_back(fmt::format("--also {} is used in frame {} and left out of frame {}",
                                now.also[i], before.fits[i] ? before.number : now.number,
                                before.fits[i] ? now.number : before.number));
  }
  return lines;
}

std::vector<std::string> compare_views(const Frame& left, const Frame& right) {
  if (left.lead().file == right.lead().file && left.lead().part == right.lead().part &&
      left.lead().channels == right.lead().channels) {
    throw Error(ExitCode::layer,
                fmt::format("{}: both views would be made from '{}'; leave out --aov, or give "
                            "--stereo left, then right",
                            left.input, left.lead().name));
  }
  if (left.plan.write == right.plan.write) return {};
  return {
      fmt::format("the views have different products, as their layers differ: left {}; right {}",
                  fmt::join(left.plan.write, ", "), fmt::join(right.plan.write, ", "))};
}

}  // namespace ssdo
