// SPDX-License-Identifier: Apache-2.0
//
// A march knows solids, which stop all light, and empty space. Samples of a deep image stop a part
// of the light each: hair and edges are averages over a pixel, media are thin. The rule:
//
//   A solid begins where all that lies behind the solid before it, or before the viewer, stops half
//   of the light.
//
// This is rounding to the nearest of open and closed, whose error is 1/2 at most and on average 0
// over an edge. Samples that never reach a half before the next solid are left out. Within a
// medium, from Z to ZBack, a share 1 - (1 - alpha)^t of the light is stopped after a share t of the
// way (OpenEXR, "Interpreting OpenEXR Deep Pixels"), so that the place of the half is
//
//   tau_before + sum rate (z - front) = ln 2,   rate = -ln(1 - alpha) / (back - front)
//
// An opaque sample with a ZBack is a solid with a known back. Where several overlap, as in merged
// elements, their union is one solid. In a medium of many thin samples the solid goes on as far as
// they join.
#include "scene/deep/ray_solids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace ssdo {
namespace {

constexpr float kHalf = 0.5f;
const double kOpticalHalf = std::log(2.0);
constexpr double kOpaque = std::numeric_limits<double>::infinity();

enum Kind { kEnd, kSurface, kBegin };

double optical_depth(float alpha) { return alpha >= 1 ? kOpaque : -std::log1p(-double(alpha)); }

}  // namespace

void RaySolids::add(std::span<const DeepSample> samples) {
  for (DeepSample s : samples) {
    if (!(s.alpha > 0) || !(s.front > 0 && s.front < far_)) continue;
    s.alpha = std::min(s.alpha, 1.0f);
    if (!(s.back > s.front)) s.back = s.front;
    samples_.push_back(s);
  }
}

void RaySolids::make_events() {
  std::sort(samples_.begin(), samples_.end(), [](const DeepSample& a, const DeepSample& b) {
    return std::tie(a.front, a.back, a.alpha) < std::tie(b.front, b.back, b.alpha);
  });
  events_.clear();
  for (const DeepSample& s : samples_) {
    const double depth = optical_depth(s.alpha);
    if (s.back == s.front || std::isinf(s.back) || depth == kOpaque) {
      events_.push_back({s.front, kSurface, depth});
    } else {
      const double rate = depth / (double(s.back) - double(s.front));
      events_.push_back({s.front, kBegin, rate});
      events_.push_back({s.back, kEnd, rate});
    }
  }
  std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
    return std::tie(a.depth, a.kind, a.optical_depth) < std::tie(b.depth, b.kind, b.optical_depth);
  });
}

/// The solid that begins at `front`: it goes on as far as samples that each stop half of the light
/// join, or else, in a medium, as far as any samples join.
RaySolid RaySolids::solid_from(float front, bool in_medium) {
  for (const float least_alpha : {kHalf, 0.0f}) {
    float back = -1;
    for (const DeepSample& s : samples_) {
      if (s.front > std::max(front, back)) break;
      if (s.alpha >= least_alpha) back = std::max(back, s.back);
    }
    if (back >= front) return {front, back};
    if (!in_medium) break;
  }
  return {front, front};
}

const std::vector<RaySolid>& RaySolids::find(std::size_t most) {
  solids_.clear();
  make_events();
  double stopped = 0, rate = 0;  // since the last solid; of the media here
  int media = 0;
  float at = 0, from = -1;  // the depth so far; the back of the last solid
  const auto begin_solid = [&](float front, bool in_medium) {
    solids_.push_back(solid_from(front, in_medium));
    from = solids_.back().back;
    stopped = 0;
  };
  for (const Event& e : events_) {
    at = std::max(at, from);
    while (media > 0 && rate > 0 && at < e.depth && solids_.size() < most) {
      const double front = at + (kOpticalHalf - stopped) / rate;
      if (front >= e.depth) {
        stopped += rate * (double(e.depth) - at);
        break;
      }
      begin_solid(std::max(float(front), at), true);
      at = std::max(from, std::nextafter(at, e.depth));
    }
    at = std::max(at, e.depth);
    if (solids_.size() == most) break;
    if (e.kind == kSurface) {
      if (e.depth <= from) continue;
      stopped += e.optical_depth;
      if (stopped >= kOpticalHalf) begin_solid(e.depth, false);
    } else {
      media += e.kind == kBegin ? 1 : -1;
      rate = media == 0 ? 0 : rate + (e.kind == kBegin ? e.optical_depth : -e.optical_depth);
    }
  }
  samples_.clear();
  return solids_;
}

}  // namespace ssdo
