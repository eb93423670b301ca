// SPDX-License-Identifier: Apache-2.0
//
// Whether the albedo at edges is premultiplied by alpha.
//
// In a pixel that a surface of albedo rho covers to the share A, a renderer that filters albedo as
// it does the beauty stores A rho. Where albedo is divided by alpha, or comes from a single sample,
// rho is stored. Fully covered pixels nearby show rho as a range [low, high] in each channel, and
// the stored a is compared with what either convention would store:
//
//   vote = (|a - [low, high]| - |a - A [low, high]|) / ((1 - A) rho)   -1 straight .. 1
//   premultiplied
//
// Where no fully covered pixel is near, a > A is a vote for straight, as no albedo is above 1.
//
// The share of the votes for premultiplied decides. The documented convention has kDocumented votes
// beforehand, and between 1/3 and 2/3 of the votes alpha is undone in part, so that one pixel more
// or less does not make a frame of a shot decide otherwise than the frames beside it.
#include "scene/gbuffer/albedo_alpha.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// From here on a pixel is fully covered: alpha is short of 1 by less than a step of 8 bits.
constexpr float kFullAlpha = 0.998f;

/// Fully covered pixels up to this many pixels away show rho; fewer than kFewest may be of other
/// surfaces.
constexpr int kNear = 2, kFewest = 2;

/// A difference between the two conventions of this much, summed over channels, has a whole vote:
/// some steps of 8 bits.
constexpr float kClear = 0.06f;

/// Votes given to the convention of ssdo.1, that rendered layers are premultiplied: as many as an
/// edge of a few pixels has, so that the noise of such an edge does not decide.
constexpr double kDocumented = 8;

struct Votes {
  double premultiplied = 0, straight = 0;
  std::size_t pixels = 0;  ///< that are partly covered

  Votes& operator+=(const Votes& other) {
    premultiplied += other.premultiplied;
    straight += other.straight;
    pixels += other.pixels;
    return *this;
  }
};

float sum(const glm::vec3& v) { return v.x + v.y + v.z; }

bool is_partly_covered(const GBuffer& g, std::size_t i) {
  return g.valid[i] && g.alpha[i] > 0 && g.alpha[i] < kFullAlpha;
}

/// The albedo of fully covered pixels around one.
struct Range {
  glm::vec3 low{INFINITY}, high{-INFINITY};
  int count = 0;

  Range(const GBuffer& g, int x, int y) {
    for (int v = std::max(y - kNear, 0); v <= std::min(y + kNear, g.alpha.height - 1); ++v) {
      for (int u = std::max(x - kNear, 0); u <= std::min(x + kNear, g.alpha.width - 1); ++u) {
        const std::size_t i = g.alpha.index(u, v);
        if (!g.valid[i] || !(g.alpha[i] >= kFullAlpha)) continue;
        low = glm::min(low, g.albedo[i]);
        high = glm::max(high, g.albedo[i]);
        ++count;
      }
    }
  }

  /// From a colour to the range times `scale`.
  float distance(const glm::vec3& color, float scale) const {
    return sum(glm::max(glm::max(scale * low - color, color - scale * high), glm::vec3(0)));
  }
};

void add_vote(const GBuffer& g, int x, int y, Votes& votes) {
  const std::size_t i = g.alpha.index(x, y);
  ++votes.pixels;
  const glm::vec3 a = g.albedo[i];
  const float alpha = g.alpha[i];
  const Range rho(g, x, y);
  if (rho.count < kFewest) {
    votes.straight += std::clamp((std::max({a.x, a.y, a.z}) - alpha) / kClear, 0.0f, 1.0f);
    return;
  }
  const float apart = (1 - alpha) * sum(rho.low + rho.high) / 2;
  if (!(apart > 0)) return;
  const float straight = rho.distance(a, 1), premultiplied = rho.distance(a, alpha);
  // Glass and smoke are partly covered too, and have the albedo of neither.
  const float fits = std::max(0.0f, 1 - std::min(straight, premultiplied) / apart);
  const float vote = fits * std::clamp((straight - premultiplied) / apart, -1.0f, 1.0f) *
                     std::min(apart / kClear, 1.0f);
  (vote > 0 ? votes.premultiplied : votes.straight) += std::abs(vote);
}

/// Added by rows: the same bits for any number of threads.
Votes count_votes(const GBuffer& g) {
  std::vector<Votes> by_row(std::size_t(g.alpha.height));
  for_each_row(g.alpha.height, [&](int y) {
    for (int x = 0; x < g.alpha.width; ++x)
      if (is_partly_covered(g, g.alpha.index(x, y))) add_vote(g, x, y, by_row[std::size_t(y)]);
  });
  Votes all;
  for (const Votes& row : by_row) all += row;
  return all;
}

float premultiplied_share(const Votes& votes) {
  const double all = votes.premultiplied + votes.straight + kDocumented,
               share = (votes.premultiplied + kDocumented) / all,
               t = std::clamp(3 * share - 1, 0.0, 1.0);
  return float(t * t * (3 - 2 * t));
}

std::string describe(const Votes& votes, float share) {
  const std::string counts =
      fmt::format("of {} partly covered pixels, {:.0f} show that it is and {:.0f} that it is not",
                  votes.pixels, votes.premultiplied, votes.straight);
  if (share >= 1 && votes.premultiplied <= votes.straight)
    return "albedo is taken as premultiplied by alpha, as rendered layers are: " + counts;
  if (share >= 1) return "albedo is premultiplied by alpha: " + counts;
  if (share <= 0) return "albedo is not premultiplied by alpha: " + counts;
  return fmt::format(
      "albedo is taken as premultiplied by alpha to {:.0f} %: {}; --aov "
      "albedo:straight=LAYER or albedo:premultiplied=LAYER states it",
      100 * share, counts);
}

}  // namespace

void undo_alpha_of_albedo(GBuffer& g, std::optional<bool> stated,
                          const std::optional<Encodings>& known) {
  if (g.albedo.empty() || g.alpha.empty()) return;
  float& share = g.encodings.albedo_premultiplied;
  if (known) {
    share = known->albedo_premultiplied;
  } else if (stated) {
    share = *stated;
    g.albedo_alpha =
        fmt::format("albedo is {}premultiplied by alpha: by --aov", *stated ? "" : "not ");
  } else if (g.grid.is_coarse()) {
    g.warnings.push_back(
        "albedo is taken as premultiplied by alpha, as rendered layers are: the overview of a "
        "frame "
        "that is made in bands shows too few edges to tell; --aov albedo:straight=LAYER or "
        "albedo:premultiplied=LAYER states it");
  } else if (const Votes votes = count_votes(g); votes.pixels > 0) {
    share = premultiplied_share(votes);
    g.albedo_alpha = describe(votes, share);
  }
  if (share <= 0) return;
  for_each_row(g.albedo.height, [&](int y) {
    for (std::size_t i = g.albedo.index(0, y), end = g.albedo.index(0, y + 1); i < end; ++i) {
      if (!is_partly_covered(g, i)) continue;
      const glm::vec3 stored = g.albedo[i], most = glm::max(stored, glm::vec3(1));
      g.albedo[i] = glm::min(stored / (1 - share * (1 - g.alpha[i])), most);
    }
  });
}

}  // namespace ssdo
