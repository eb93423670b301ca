// SPDX-License-Identifier: Apache-2.0
#include "scene/deep/deep_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel/tiles.h"
#include "scene/deep/ray_solids.h"
#include "scene/gbuffer/background.h"
#include "scene/gbuffer/depth_encoding.h"

namespace ssdo {
namespace {

bool is_broken(const DeepSample& s) { return std::isnan(s.front) || std::isnan(s.alpha); }

}  // namespace

DeepImage read_deep_frame(const ExrReader& file, const DeepChannels& channels,
                          const GBufferOptions& options, std::vector<std::string>& warnings) {
  DeepImage image = read_deep(file, channels);
  if (image.samples.empty()) {
    warnings.push_back(fmt::format("{}: holds no deep sample in any pixel", image.file));
    return image;
  }
  for (DeepSample& s : image.samples) {
    s.front = decoded_depth(s.front, options);
    s.back = decoded_depth(s.back, options);
  }
  if (const auto broken = std::ranges::count_if(image.samples, is_broken)) {
    warnings.push_back(
        fmt::format("{}: {} of {} deep samples have a Z or alpha that is no number, "
                    "and are left out",
                    image.file, broken, image.samples.size()));
  }
  const auto is_positive = [](const DeepSample& s) { return !(s.front < 0); };
  if (std::any_of(image.samples.begin(), image.samples.end(), is_positive)) return image;
  for (DeepSample& s : image.samples) s.front = -s.front, s.back = -s.back;
  warnings.push_back(
      fmt::format("{}: its deep samples have a negative Z, as that of a camera that looks along "
                  "-z; their sign is turned",
                  image.file));
  return image;
}

std::size_t broken_pixels(const DeepImage& image) {
  std::size_t count = 0;
  for (int y = image.window.y0; y < image.window.y1; ++y)
    for (int x = image.window.x0; x < image.window.x1; ++x)
      count += std::ranges::any_of(image.at(x, y), is_broken);
  return count;
}

float farthest_sample(const GBufferOptions& options) {
  return options.background_depth ? std::min(*options.background_depth, kEmptyDepth) : kEmptyDepth;
}

Plane<float> nearest_surfaces(const DeepImage& image, float far) {
  Plane<float> depth(image.window.width(), image.window.height(),
                     std::numeric_limits<float>::infinity());
  for_each_row(depth.height, [&](int y) {
    RaySolids ray(far);
    for (int x = 0; x < depth.width; ++x) {
      ray.add(image.at(image.window.x0 + x, image.window.y0 + y));
      const std::vector<RaySolid>& solids = ray.find(1);
      if (!solids.empty()) depth(x, y) = solids[0].front;
    }
  });
  return depth;
}

}  // namespace ssdo
