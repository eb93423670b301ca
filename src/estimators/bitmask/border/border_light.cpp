// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/border/border_light.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <glm/vec4.hpp>
#include <vector>

#include "math/bf16x2.h"
#include "math/luminance.h"
#include "parallel/tiles.h"

namespace ssdo {

SentAtBorder sent_at_border(const MarchScene& scene, const InterleavedVectors& radiance,
                            bool two_sided) {
  SentAtBorder sent;
  // A mask, because g++ 12 with -O2 turns a choice between unpack_bf16_first() and the number into
  // the number.
  const std::uint32_t kept = two_sided ? kUpperHalf : ~std::uint32_t(0);
  for (std::size_t c = 0; c < 3; ++c) {
    sent[c] = scene.border.gather([&](int x, int y) {
      const std::ptrdiff_t i = scene.layout.index(x, y);
      const float both = scene.shows_surface(i) ? radiance[c][i] : 0.0f;
      return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) & kept);
    });
  }
  return sent;
}

SentAtBorder without_lamps(SentAtBorder sent, const std::vector<LampBeyond>& lamps) {
  for (const LampBeyond& of : lamps) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < sent[c].size(); ++i)
        sent[c][i] = std::max(sent[c][i] - of.sent[c][i], 0.0f);
    }
  }
  return sent;
}

SentAtBorder light_beyond(SentAtBorder sent, const SentAtBorder& of_all, float level) {
  for (std::size_t i = 0; i < of_all[0].size(); ++i) {
    const float light = luminance({of_all[0][i], of_all[1][i], of_all[2][i]});
    if (!(light > level)) continue;
    for (BorderValues& channel : sent) channel[i] *= level / light;
  }
  return sent;
}

glm::vec3 mean_sent(const MarchScene& scene, const Geometry& geometry, const SentByAll& sent) {
  const Window& display = geometry.display;
  const Window shown =
      intersection(scene.raster(), {-scene.first_x, -scene.first_y, display.width() - scene.first_x,
                                    display.height() - scene.first_y});
  const std::uint32_t kept = sent.two_sided ? kUpperHalf : ~std::uint32_t(0);
  const auto front_of = [&](const InterleavedVectors& light, std::ptrdiff_t i) {
    glm::vec3 front;
    for (int c = 0; c < 3; ++c)
      front[c] =
          std::bit_cast<float>(std::bit_cast<std::uint32_t>(light[std::size_t(c)][i]) & kept);
    return front;
  };
  // By row, so that sums have one order.
  std::vector<glm::dvec4> rows(std::size_t(std::max(shown.height(), 0)), glm::dvec4(0));
  for_each_row(shown.height(), [&](int row) {
    if ((shown.y0 + row + scene.first_y) % sent.rows_apart != 0) return;
    glm::dvec4& sum = rows[std::size_t(row)];
    for (int x = shown.x0; x < shown.x1; ++x) {
      const std::ptrdiff_t i = scene.layout.index(x, shown.y0 + row);
      if (!scene.shows_surface(i)) continue;
      const float light = luminance(front_of(sent.of_all, i)),
                  times = light > sent.level ? sent.level / light : 1;
      sum += glm::dvec4(times * front_of(sent.radiance, i), 1);
    }
  });
  glm::dvec4 sum(0);
  for (const glm::dvec4& row : rows) sum += row;
  return glm::vec3(sum) / float(std::max(sum.w, 1.0));
}

}  // namespace ssdo
