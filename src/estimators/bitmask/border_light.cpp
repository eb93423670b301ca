// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/border_light.h"

#include <bit>
#include <cstdint>

#include "math/luminance.h"
#include "math/two_in_one.h"

namespace ssdo {

namespace {

/// What the front sides of the pixels at the border send.
std::array<BorderValues, 3> sent_at_border(const MarchScene& scene,
                                           const InterleavedVectors& radiance, bool two_sided) {
  std::array<BorderValues, 3> sent;
  // By a mask: of a choice between first_of_two() and the number, g++ 12 takes the latter with -O2.
  const std::uint32_t kept = two_sided ? kFirstOfTwo : ~std::uint32_t(0);
  for (std::size_t c = 0; c < 3; ++c) {
    sent[c] = scene.border.gather([&](int x, int y) {
      const float both = radiance[c][scene.layout.index(x, y)];
      return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) & kept);
    });
  }
  return sent;
}

}  // namespace

std::array<BorderValues, 3> light_beyond(const MarchScene& scene,
                                         const InterleavedVectors& radiance,
                                         const InterleavedVectors& of_all, bool two_sided,
                                         float level) {
  std::array<BorderValues, 3> beyond = sent_at_border(scene, radiance, two_sided);
  const std::array<BorderValues, 3> all = sent_at_border(scene, of_all, two_sided);
  for (std::size_t i = 0; i < all[0].size(); ++i) {
    const float light = luminance({all[0][i], all[1][i], all[2][i]});
    if (!(light > level)) continue;
    for (BorderValues& channel : beyond) channel[i] *= level / light;
  }
  return beyond;
}

}  // namespace ssdo
