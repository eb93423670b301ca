// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sun.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>

namespace ssdo {
namespace {

constexpr float kPi = glm::pi<float>();
constexpr std::size_t kMaxSuns = 4;
constexpr int kMaxTries = 16;       ///< bright places examined, whether suns or not
constexpr int kPatchColumns = 128;  ///< patches of 2.8 degrees
constexpr float kMinShare = 0.05f;  ///< of the irradiance: how much darker its shadow is
const float kMaxRadius = glm::radians(5.0f);

/// Connected texels brighter than this share of the brightest belong to the same source. A source
/// less than five times as bright as its surroundings cannot reach kMinShare within kMaxRadius.
constexpr float kCoreShare = 0.2f;

using Patch = Environment::Patch;

/// Bright texels that touch each other.
struct Core {
  glm::vec3 center{0};
  float radius = 0;     ///< radians, to its farthest texel
  float threshold = 0;  ///< brightness that its texels have
};

/// Looks for suns in a map and removes them from it.
class SunSearch {
 public:
  explicit SunSearch(const Environment& whole)
      : whole_(whole), map_(*whole.map()), texel_(kPi / float(map_.height)) {}

  SunsAndRest run();

 private:
  glm::ivec2 brightest_near(const glm::vec3& d) const;
  std::optional<Core> grow(const glm::ivec2& peak) const;
  std::optional<Sun> take(const Core& core, float irradiance);

  /// Calls `visit` with the column, the row and the direction of every texel within `radius` of d.
  template <class Visit>
  void for_each_texel(const glm::vec3& d, float radius, const Visit& visit) const;

  const Environment& whole_;
  Plane<glm::vec3> map_;  ///< without the suns found so far
  float texel_;           ///< height in radians
};

template <class Visit>
void SunSearch::for_each_texel(const glm::vec3& d, float radius, const Visit& visit) const {
  const glm::vec2 at = whole_.texel_at(d);
  const float polar = at.y * texel_;
  const int y0 = std::max(0, int((polar - radius) / texel_));
  const int y1 = std::min(map_.height - 1, int((polar + radius) / texel_));
  // The meridians that touch the cone; all of them if it holds a pole.
  const float widest = std::sin(radius) / std::max(std::sin(polar), 1e-6f);
  const bool pole = polar <= radius || polar >= kPi - radius || widest >= 1;
  const float share = pole ? 0.5f : std::asin(widest) / (2 * kPi);
  const int reach = int(std::ceil(share * float(map_.width))) + 1;
  const int x0 = pole ? 0 : int(at.x) - reach;
  const int count = pole ? map_.width : std::min(2 * reach + 1, map_.width);
  const float edge = std::cos(radius);
  for (int y = y0; y <= y1; ++y) {
    for (int i = 0; i < count; ++i) {
      const int x = (x0 + i + map_.width) % map_.width;
      const glm::vec3 direction = whole_.texel_direction(x, y);
      if (glm::dot(direction, d) >= edge) visit(x, y, direction);
    }
  }
}

glm::ivec2 SunSearch::brightest_near(const glm::vec3& d) const {
  glm::ivec2 brightest =
      glm::min(glm::ivec2(whole_.texel_at(d)), glm::ivec2(map_.width - 1, map_.height - 1));
  for_each_texel(d, 2 * kPi / kPatchColumns, [&](int x, int y, const glm::vec3&) {
    if (brightness(map_(x, y)) > brightness(map_(brightest.x, brightest.y))) brightest = {x, y};
  });
  return brightest;
}

/// Floods from the brightest texel; nothing if the source is larger than kMaxRadius.
std::optional<Core> SunSearch::grow(const glm::ivec2& peak) const {
  Core core;
  core.threshold = kCoreShare * brightness(map_(peak.x, peak.y));
  if (!(core.threshold > 0) || texel_ / 2 > kMaxRadius) return std::nullopt;
  const glm::vec3 first = whole_.texel_direction(peak.x, peak.y);
  const int rows = int(2 * kMaxRadius / texel_) + 2, top = peak.y - rows;
  std::vector<bool> seen(std::size_t(2 * rows + 1) * std::size_t(map_.width));
  std::vector<glm::ivec2> open{peak};
  std::vector<glm::vec3> directions;
  seen[std::size_t(rows) * std::size_t(map_.width) + std::size_t(peak.x)] = true;
  while (!open.empty()) {
    const glm::ivec2 at = open.back();
    open.pop_back();
    const glm::vec3 d = whole_.texel_direction(at.x, at.y);
    if (glm::dot(d, first) < std::cos(2 * kMaxRadius)) return std::nullopt;
    directions.push_back(d);
    core.center += brightness(map_(at.x, at.y)) * whole_.texel_solid_angle(at.y) * d;
    for (int y = std::max(0, at.y - 1); y <= std::min(map_.height - 1, at.y + 1); ++y) {
      for (int step = -1; step <= 1; ++step) {
        const int x = (at.x + step + map_.width) % map_.width;
        const std::size_t index = std::size_t(y - top) * std::size_t(map_.width) + std::size_t(x);
        if (seen[index] || brightness(map_(x, y)) < core.threshold) continue;
        seen[index] = true;
        open.emplace_back(x, y);
      }
    }
  }
  core.center = glm::normalize(core.center);
  for (const glm::vec3& d : directions) {
    core.radius = std::max(core.radius, glm::distance(d, core.center));
  }
  return core.radius <= kMaxRadius ? std::optional(core) : std::nullopt;
}

/// Flattens the map around `core` to the radiance of a ring about it. What that takes away is the
/// sun, if it is enough of the irradiance there; otherwise the map stays.
std::optional<Sun> SunSearch::take(const Core& core, float irradiance) {
  // Twice the radius catches most of the glow. Two texels are for partly covered ones.
  const float disc = std::max(core.radius, std::min(2 * core.radius, kMaxRadius)) + 2 * texel_;
  const float ring = disc + std::max(2 * texel_, glm::radians(1.0f));
  glm::dvec3 around(0);
  double solid_angle = 0;
  for_each_texel(core.center, ring, [&](int x, int y, const glm::vec3& d) {
    if (glm::distance(d, core.center) <= disc) return;
    if (brightness(map_(x, y)) >= core.threshold) return;  // another sun
    around += double(whole_.texel_solid_angle(y)) * glm::dvec3(map_(x, y));
    solid_angle += whole_.texel_solid_angle(y);
  });
  if (solid_angle == 0) return std::nullopt;
  const glm::vec3 background(around / solid_angle);

  glm::dvec3 power(0), direction(0);
  for_each_texel(core.center, disc, [&](int x, int y, const glm::vec3& d) {
    const glm::vec3 excess = whole_.texel_solid_angle(y) * (map_(x, y) - background);
    power += glm::dvec3(excess);
    direction += double(std::max(0.0f, brightness(excess))) * glm::dvec3(d);
  });
  Sun sun;
  sun.irradiance = whole_.gain() / kPi * glm::max(glm::vec3(power), 0.0f);
  if (!(brightness(sun.irradiance) > kMinShare * irradiance)) return std::nullopt;
  sun.direction = glm::vec3(glm::normalize(direction));

  double weights = 0, squares = 0;
  for_each_texel(core.center, disc, [&](int x, int y, const glm::vec3& d) {
    const glm::vec3 excess = map_(x, y) - background;
    const double weight = std::max(0.0f, brightness(excess)) * whole_.texel_solid_angle(y);
    const double distance = glm::distance(d, sun.direction);
    weights += weight;
    squares += weight * distance * distance;
    // A channel that is darker here than around keeps its texels and adds nothing to the sun.
    for (int c = 0; c < 3; ++c) map_(x, y)[c] = power[c] > 0 ? background[c] : map_(x, y)[c];
  });
  // The mean square over a disc is half its radius squared.
  sun.angular_radius = std::max(texel_ / 2, float(std::sqrt(2 * squares / weights)));
  return sun;
}

SunsAndRest SunSearch::run() {
  std::vector<Patch> sky = whole_.patches(glm::mat3(1), kPatchColumns);
  const std::vector<Patch> all = sky;
  std::vector<Sun> suns;
  for (int i = 0; i < kMaxTries && suns.size() < kMaxSuns; ++i) {
    const auto by_power = [](const Patch& a, const Patch& b) {
      return brightness(a.power) < brightness(b.power);
    };
    const glm::vec3 d = std::max_element(sky.begin(), sky.end(), by_power)->direction;
    float irradiance = 0, near = 0;  // over pi
    for (const Patch& patch : all) {
      irradiance += brightness(patch.power) * std::max(0.0f, glm::dot(patch.direction, d)) / kPi;
    }
    for (const Patch& patch : all) {
      if (glm::dot(patch.direction, d) < std::cos(2 * kMaxRadius)) continue;
      near += std::max(0.0f, brightness(patch.power)) / kPi;
    }
    std::optional<Core> core;
    std::optional<Sun> sun;
    if (near > kMinShare * irradiance) core = grow(brightest_near(d));
    if (core) sun = take(*core, irradiance);
    if (sun) suns.push_back(*sun);
    // This place is not examined again; another sun may stand beside it.
    const float done = (sun ? 2 * core->radius : kMaxRadius) + 2 * kPi / kPatchColumns;
    for (Patch& patch : sky) {
      if (glm::dot(patch.direction, d) >= std::cos(done)) patch.power = glm::vec3(0);
    }
  }
  if (suns.empty()) return {{}, whole_};
  std::sort(suns.begin(), suns.end(), [](const Sun& a, const Sun& b) {
    return brightness(a.irradiance) > brightness(b.irradiance);
  });
  const auto rest = std::make_shared<const Plane<glm::vec3>>(std::move(map_));
  return {std::move(suns), Environment(rest, whole_.frame())};
}

}  // namespace

SunsAndRest take_suns(const Environment& whole) { return SunSearch(whole).run(); }

}  // namespace ssdo
