// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/contributing_frame.h"

#include <algorithm>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Whether two frames have planes of the same kinds, of which either may lack some.
bool same_things(const Findings& a, const Findings& b) {
  return std::ranges::equal(a.planes, b.planes, {}, &FoundPlane::source, &FoundPlane::source);
}

/// For each channel of `own`, the corresponding channel of another frame; -1: it has none.
std::vector<int> channels_in(const Findings& other, const Findings& own) {
  std::vector<int> channels;
  int there = 0;
  for (std::size_t k = 0; k < own.planes.size(); ++k) {
    const int count = other.planes[k].channels;
    for (int c = 0; c < own.planes[k].channels; ++c) channels.push_back(count > 0 ? there + c : -1);
    there += count;
  }
  channels.resize(std::size_t(own.stride), -1);
  return channels;
}

/// The values of another frame in the order of one's own channels.
std::vector<std::uint16_t> arrange(const Findings& other, const std::vector<int>& channels) {
  std::vector<std::uint16_t> values(other.surfaces.size() * channels.size());
  for_each_row(other.surfaces.window.height() + 2, [&](int row) {
    const auto stride = std::size_t(other.surfaces.stride());
    for (std::size_t i = std::size_t(row) * stride; i < std::size_t(row + 1) * stride; ++i)
      for (std::size_t c = 0; c < channels.size(); ++c)
        values[i * channels.size() + c] =
            channels[c] < 0
                ? 0
                : other.values[i * std::size_t(other.stride) + std::size_t(channels[c])];
  });
  return values;
}

/// The part of the radiance that is the same in both frames, over points that both show.
float same_glow(const Findings& own, const Findings& other, const ShotReprojection& reprojection) {
  if (own.glow.empty() && other.glow.empty()) return 1;
  const int step = grid_step(own.surfaces);
  double same = 0, all = 0;
  for_each_points_of_grid(own.surfaces, step, [&](const RowOfPixels& row) {
    RowOfPoints points;
    ReprojectedPoints sights;
    load_points(own.surfaces, row, points);
    if (!reprojection.find(points, sights)) return;
    for (int i = 0; i < row.count; ++i) {
      if (sights.pixel[i] < 0) continue;
      const float here =
          own.glow.empty() ? 0 : own.glow[own.surfaces.index(row.x + i * step, row.y)];
      float there = 0;
      for (int k = 0; k < 4 && !other.glow.empty(); ++k)
        there += sights.weight[k][i] *
                 other.glow[std::size_t(sights.pixel[i] + k % 2 + k / 2 * other.surfaces.stride())];
      same += double(std::min(here, there)), all += double(std::max(here, there));
    }
  });
  return all > 0 ? float(same / all) : 1;
}

ContributingFrame contributing_frame_of(const Findings& own,
                                        const std::vector<OtherFindings>& others, std::size_t at,
                                        const Light& light, const std::vector<int>& kinds) {
  const OtherFindings& other = others[at];
  const Findings& findings = *other.findings;
  ContributingFrame frame{findings, at, {findings.surfaces, own.surfaces}, {}, {}, {}, {}, {}};
  const std::vector<MovedPiece> pieces = moved_pieces(own.surfaces.camera, findings.surfaces.camera,
                                                      *other.disappeared, *other.appeared);
  if (!pieces.empty()) {
    frame.moved.emplace(own.surfaces, pieces, light);
    frame.moved->weigh_moving(own.surfaces, *other.disappeared, own.motion, other.away);
  }
  const float glow = same_glow(own, findings, frame.reprojection);
  for (const FoundPlane& plane : own.planes)
    frame.weights.insert(frame.weights.end(), std::size_t(plane.channels),
                         plane.source == FoundPlane::kOfSenders ? glow : 1);
  const auto stride = std::size_t(own.stride);
  frame.weights.resize(stride, 1);
  const std::vector<int> channels = channels_in(findings, own);
  if (!std::ranges::equal(findings.planes, own.planes, {}, &FoundPlane::channels,
                          &FoundPlane::channels))
    frame.arranged = arrange(findings, channels);
  frame.weights_of_kinds.resize((light.sources.size() + 1) * stride, 0);
  for (std::size_t c = 0; c < stride; ++c) {
    if (channels[c] < 0) frame.weights[c] = 0;
    frame.weights_of_kinds[std::size_t(kinds[c]) * stride + c] = frame.weights[c];
    frame.units.push_back(channels[c] < 0 ? 1
                                          : findings.unit[std::size_t(channels[c])] / own.unit[c]);
  }
  return frame;
}

}  // namespace

std::vector<ContributingFrame> contributing_frames_of(const Findings& own,
                                                      const std::vector<OtherFindings>& others,
                                                      const Light& light,
                                                      const std::vector<int>& kinds) {
  std::vector<ContributingFrame> frames;
  for (std::size_t at = 0; at < others.size(); ++at)
    if (others[at].findings->surfaces.world_known && same_things(own, *others[at].findings))
      frames.push_back(contributing_frame_of(own, others, at, light, kinds));
  return frames;
}

}  // namespace ssdo
