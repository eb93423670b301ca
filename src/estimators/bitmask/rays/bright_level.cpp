// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/bright_level.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>
#include <vector>

#include "estimators/bitmask/march.h"
#include "math/bf16x2.h"
#include "math/luminance.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// How much brighter than its surroundings a sender must be for rays to go to it: the light of a
/// less bright sender has less noise from the march than from the shadows of rays.
constexpr float kBright = 4;

/// Shares of the light that the frame shows: if less than the first exceeds the level, rays, which
/// cost half of the estimate, gather nothing; if more than the second does, they gather all of it.
constexpr double kLeastShare = 0.05, kFullShare = 0.15;

/// Luminance of what pixels show.
struct Brightness {
  double roots = 0, surfaces = 0;
  float most = 0;

  void operator+=(const Brightness& other) {
    roots += other.roots, surfaces += other.surfaces;
    most = std::max(most, other.most);
  }
  float mean() const {
    const double root = surfaces > 0 ? roots / surfaces : 0;
    return float(root * root);
  }
};

/// Light as the frame shows it.
struct Excess {
  double above = 0, all = 0;  ///< a level

  void operator+=(const Excess& other) { above += other.above, all += other.all; }
  double share() const { return all > 0 ? above / all : 0; }
};

/// Sums over the surfaces of the lit rows: `add(sums, front, back)` has the luminance of both
/// sides. Added by rows: the same bits for any number of threads.
template <class Sums, class Add>
Sums sum_of(const SentLight& sent, const Add& add) {
  const MarchScene& scene = sent.scene;
  std::vector<Sums> rows(std::size_t(sent.lit.height()));
  for_each_row(sent.lit.height(), [&](int row) {
    const int y = sent.lit.y0 + row, width = scene.layout.width();
    for (int first = 0; first < std::min(Interleaving::kPeriod, width); ++first) {
      std::ptrdiff_t i = scene.layout.index(first, y);
      for (int x = first; x < width; x += Interleaving::kPeriod, ++i) {
        if (!scene.shows_surface(i)) continue;
        const glm::vec3 both(sent.radiance[0][i], sent.radiance[1][i], sent.radiance[2][i]);
        const auto side = [&](float (*of)(float)) {
          return luminance({of(both.x), of(both.y), of(both.z)});
        };
        const float front = sent.two_sided ? side(unpack_bf16_first) : luminance(both);
        add(rows[std::size_t(row)], front, sent.two_sided ? side(unpack_bf16_second) : front);
      }
    }
  });
  Sums all;
  for (const Sums& of_row : rows) all += of_row;
  return all;
}

Brightness brightness_of(const SentLight& sent) {
  return sum_of<Brightness>(sent, [](Brightness& b, float front, float back) {
    b.roots += double(std::sqrt(std::max(front, 0.0f)));
    b.surfaces += 1;
    b.most = std::max({b.most, front, back});
  });
}

/// The level above which rays gather light (emitters.h). It rises as less of the frame's light is
/// above `bright`; it is infinite if so little is that the march gathers all of it.
float level_of(const SentLight& sent, float bright) {
  const Excess excess = sum_of<Excess>(sent, [=](Excess& e, float front, float) {
    e.above += double(std::max(front - bright, 0.0f));
    e.all += double(std::max(front, 0.0f));
  });
  const double t =
      std::clamp((excess.share() - kLeastShare) / (kFullShare - kLeastShare), 0.0, 1.0);
  return float(bright / (t * t * (3 - 2 * t)));
}

}  // namespace

BrightLevel bright_level(const SentLight& sent) {
  if (sent.overview_light) return {sent.overview_light->bright, sent.overview_light->level};
  const Brightness b = brightness_of(sent);
  const float bright = kBright * b.mean();
  if (b.most <= bright) return {bright, std::numeric_limits<float>::infinity()};
  return {bright, level_of(sent, bright)};
}

}  // namespace ssdo
