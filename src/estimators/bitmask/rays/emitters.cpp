// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/emitters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <utility>

#include "estimators/bitmask/march.h"
#include "estimators/bitmask/rays/bright_level.h"
#include "math/bf16x2.h"
#include "math/infinity.h"
#include "math/luminance.h"
#include "math/sobol.h"
#include "parallel/tiles.h"
#include "scene/solids/unseen_side.h"

namespace ssdo {
namespace {

constexpr int kTile = 16;  ///< pixels

/// The largest change in depth from a pixel of a body to the next, in widths of a pixel there.
constexpr float kMostSlope = 8;

/// Rim::growth above which a body counts as round: that at the rim of a ball 200 pixels wide.
constexpr float kLeastGrowth = 0.02f;

/// One side of the surface in a pixel, with the light that it sends above the level.
struct Side {
  Emitter point;  ///< as if it stood for the pixel alone
  float light;    ///< luminance of the radiance, less the level

  double power() const { return double(light) * double(point.area); }
};

glm::vec3 each(float (*of)(float), const glm::vec3& v) { return {of(v.x), of(v.y), of(v.z)}; }

/// The pixels of a raster that send.
class Senders {
 public:
  /// Solids within `beside_px` pixels of a point do not hide it.
  Senders(const MarchScene& scene, const InterleavedVectors& radiance, bool two_sided, float level,
          float beside_px)
      : scene_(scene),
        radiance_(radiance),
        two_sided_(two_sided),
        level_(level),
        beside_px_(beside_px) {}

  /// Calls `visit(side)` for the sides of a pixel that send more than the level. `i` is the index
  /// of its radiance.
  template <class Visit>
  void for_each_side(int x, int y, std::ptrdiff_t i, const Visit& visit) const {
    const std::ptrdiff_t at = scene_.layout.index(x, y);
    if (!scene_.shows_surface(at)) return;
    const glm::vec3 both(radiance_[0][i], radiance_[1][i], radiance_[2][i]);
    const glm::vec3 front = two_sided_ ? each(unpack_bf16_first, both) : both,
                    back = two_sided_ ? each(unpack_bf16_second, both) : both;
    const auto visit_side = [&](const glm::vec3& radiance, bool is_back) {
      Side s = side(radiance, x, y, at, is_back);
      s.point.pixel = int(i), s.point.is_back = is_back;
      visit(s);
    };
    if (luminance(front) > level_) visit_side(front, false);
    const float thickness = scene_.layers.front().thickness[at];
    const bool ends =
        thickness < (scene_.orthographic ? kInfiniteThickness : kInfiniteThicknessRatio);
    if (ends && luminance(back) > level_) visit_side(back, true);
  }

 private:
  glm::vec3 to_viewer(int x, int y) const {
    return scene_.orthographic ? glm::vec3(0, 0, 1)
                               : glm::normalize(glm::vec3(-ray_slope(scene_, x, y), 1));
  }

  /// How a body curves away from the camera at a pixel.
  struct Rim {
    float growth;  ///< of u^2 per pixel towards its inside, u the cosine to the viewer
    bool is_last;  ///< pixels beside it are not on the body
  };

  Rim rim(int x, int y, float u2) const {
    const Interleaving& layout = scene_.layout;
    const float depth = scene_.depth()[layout.index(x, y)], width = scene_.orthographic ? 1 : depth,
                most = kMostSlope * width / std::min(scene_.fx, scene_.fy);
    Rim rim{0, false};
    const auto more_at = [&](int dx, int dy) {
      const int qx = x + dx, qy = y + dy;
      if (qx < 0 || qy < 0 || qx >= layout.width() || qy >= layout.height()) return 0.0f;
      if (!(std::abs(scene_.depth()[layout.index(qx, qy)] - depth) < most)) {
        rim.is_last = true;
        return 0.0f;
      }
      const float u = glm::dot(tangent_normal(scene_, qx, qy), to_viewer(qx, qy));
      return std::max(u * std::abs(u) - u2, 0.0f);
    };
    rim.growth = std::hypot(std::max(more_at(-1, 0), more_at(1, 0)),
                            std::max(more_at(0, -1), more_at(0, 1)));
    return rim;
  }

  /// What a pixel shows of a body.
  struct Patch {
    float over_cosine;  ///< its area over that of a plane across its ray
    float width_px;     ///< of the body, in pixels, at its rim; else 0
  };

  /// The area is the mean of 1 / u, where u^2 changes linearly. On a ball of R pixels, u^2 is 1 -
  /// (d / R)^2, and grows by 2 / R per pixel at the rim. The last pixel stands for all of the
  /// surface up to the rim, and for r^2 / distance per unit of the rim's length beyond it, where a
  /// camera sees less of the ball the nearer it is.
  Patch patch(int x, int y, float u) const {
    constexpr float kFrontal = 0.8f;  // 1 / u hardly changes within a pixel
    if (u > kFrontal) return {1 / u, 0};
    const float u2 = u * u;
    auto [growth, is_last] = rim(x, y, u2);
    if ((is_last && growth > kLeastGrowth) || u2 < growth) {
      growth += 0.5f * growth * growth;  // at the rim, a pixel further out than where it is found
      const float beyond = scene_.orthographic ? 0 : 4 / (growth * std::min(scene_.fx, scene_.fy));
      return {(2 * std::sqrt(u2 + 0.5f * growth) + beyond) / growth, 4 / growth};
    }
    const float half = 0.5f * growth;
    return {2 / (std::sqrt(u2 + half) + std::sqrt(std::max(u2 - half, 0.0f))), 0};
  }

  /// The unit normal of the unseen side where the ends of the view rays in the solid bend away from
  /// the shown surface; as ends_of_rays() of rays/unseen_side-inl.h.
  std::optional<glm::vec3> normal_behind(int x, int y) const {
    const Interleaving& layout = scene_.layout;
    const InterleavedPlane &depths = scene_.depth(), &thicknesses = scene_.layers.front().thickness;
    const auto nearness = [&](float depth) { return scene_.orthographic ? -depth : 1 / depth; };
    const auto end_of = [&](std::ptrdiff_t i) {
      return scene_.orthographic ? depths[i] + thicknesses[i] : depths[i] * (1 + thicknesses[i]);
    };
    const std::ptrdiff_t at = layout.index(x, y);
    const float front = nearness(depths[at]), back = nearness(end_of(at)),
                per_front = scene_.orthographic ? 1 : 1 / front,
                per_back = scene_.orthographic ? 1 : 1 / back;
    const glm::vec2 shown(unpack_bf16_first(scene_.tilt[at]), unpack_bf16_second(scene_.tilt[at]));
    const auto slope_to = [&](int dx, int dy) {
      const int qx = x + dx, qy = y + dy;
      if (qx < 0 || qy < 0 || qx >= layout.width() || qy >= layout.height()) return kInfinity;
      const std::ptrdiff_t q = layout.index(qx, qy);
      const float from_plane = (nearness(depths[q]) - front) * per_front -
                               glm::dot(shown, glm::vec2(float(dx), float(dy)));
      const bool is_flat = std::abs(from_plane) < kMostCurve / (dx != 0 ? scene_.fx : scene_.fy);
      return is_flat ? (nearness(end_of(q)) - back) * per_back : kInfinity;
    };
    const auto lesser_slope = [](float before, float after) {
      return std::abs(after) <= std::abs(before) ? after : -before;
    };
    const glm::vec2 tilt(lesser_slope(slope_to(-1, 0), slope_to(1, 0)),
                         lesser_slope(slope_to(0, -1), slope_to(0, 1)));
    const glm::vec2 bends = glm::abs(tilt - shown) * glm::vec2(scene_.fx, scene_.fy);
    const float bend = std::max(bends.x, bends.y);
    if (!(bend > kLeastBend && bend < kInfinity)) return {};
    const glm::vec2 aside = tilt * glm::vec2(-scene_.fx, scene_.fy),
                    slope = scene_.orthographic ? glm::vec2(0) : ray_slope(scene_, x, y);
    return -glm::normalize(glm::vec3(aside, 1 + glm::dot(aside, slope)));
  }

  Side side(const glm::vec3& radiance, int x, int y, std::ptrdiff_t at, bool is_back) const {
    const float depth = scene_.depth()[at], thickness = scene_.layers.front().thickness[at];
    const glm::vec3 normal = tangent_normal(scene_, x, y), view = to_viewer(x, y);
    const float width = scene_.orthographic ? 1 : depth, per_depth = 1 / view.z,
                u = std::max(glm::dot(normal, view), kLeastFacing);
    const glm::vec2 slope = ray_slope(scene_, x, y);
    const glm::vec3 front =
        scene_.orthographic ? glm::vec3(slope, -depth) : depth * glm::vec3(slope, -1);
    const std::optional<glm::vec3> behind = is_back ? normal_behind(x, y) : std::nullopt;
    const Patch shown =
        behind ? Patch{1 / std::max(-glm::dot(*behind, view), kLeastFacing), 0} : patch(x, y, u);
    const float area = width * width * shown.over_cosine / (per_depth * scene_.fx * scene_.fy),
                pixel = width * per_depth / std::min(scene_.fx, scene_.fy);
    const float length = thickness * width * per_depth, light = luminance(radiance);
    const float through = std::max(way_through(length, pixel), shown.width_px * pixel * u);
    Side out;
    out.light = light - level_;
    out.point.position = is_back ? front - through * view : front;
    out.point.normal = is_back ? behind.value_or(unseen_normal(normal, view)) : normal;
    out.point.per_radiance = out.light / light * area;
    out.point.power = out.light / light * area * radiance;
    out.point.area = area;
    out.point.solid = beside_px_ * pixel + (is_back ? 0.5f * through : 0);
    return out;
  }

  const MarchScene& scene_;
  const InterleavedVectors& radiance_;
  bool two_sided_;
  float level_, beside_px_;
};

/// The pixels of a raster, tile by tile, in an order that seldom leaps.
class Tiles {
 public:
  explicit Tiles(const Window& window)
      : window_(window),
        columns_((window.width() + kTile - 1) / kTile),
        rows_((window.height() + kTile - 1) / kTile) {}

  std::size_t count() const { return std::size_t(columns_) * std::size_t(rows_); }

  /// Calls `visit(x, y)` for the pixels of a tile.
  template <class Visit>
  void for_each_pixel(std::size_t tile, const Visit& visit) const {
    const int row = int(tile) / columns_, in_row = int(tile) % columns_,
              column = row % 2 ? columns_ - 1 - in_row : in_row;
    const int x0 = window_.x0 + column * kTile, x1 = std::min(x0 + kTile, window_.x1),
              y0 = window_.y0 + row * kTile, y1 = std::min(y0 + kTile, window_.y1);
    for (int y = y0; y < y1; ++y) {
      for (int k = 0; k < x1 - x0; ++k) visit((y - y0) % 2 ? x1 - 1 - k : x0 + k, y);
    }
  }

 private:
  Window window_;
  int columns_, rows_;
};

/// Some rows of a raster that send light.
struct Part {
  Senders senders;
  Tiles tiles;
  const Interleaving& layout;
  const OverviewRaster* far;  ///< the order of the radiance, if that is not `layout`

  template <class Visit>
  void for_each_side(std::size_t tile, const Visit& visit) const {
    tiles.for_each_pixel(tile, [&](int x, int y) {
      senders.for_each_side(x, y, far ? far->index(x, y) : layout.index(x, y), [&](Side s) {
        s.point.is_far = far != nullptr;
        visit(s);
      });
    });
  }
};

/// The lit rows of the raster and, where the raster is a band of a frame, the other rows of the
/// frame as the overview shows them.
std::vector<Part> parts_of(const SentLight& sent, float level) {
  std::vector<Part> parts;
  const auto add = [&](const MarchScene& scene, const InterleavedVectors& radiance,
                       const Window& rows, const OverviewRaster* far) {
    // Rays that come from afar see pixels of the overview.
    const float beside_px = sent.far && !far ? kBesidePx * Interleaving::kPeriod : kBesidePx;
    if (rows.height() > 0) {
      parts.push_back(
          {{scene, radiance, sent.two_sided, level, beside_px}, Tiles(rows), scene.layout, far});
    }
  };
  add(sent.scene, sent.radiance, sent.lit, nullptr);
  if (!sent.far) return parts;
  const OverviewRaster& far = sent.far->raster;
  const auto far_row = [&](int y) {
    const int of_frame =
        (y + sent.scene.first_y + Interleaving::kPeriod / 2) >> Interleaving::kShift;
    return std::clamp(of_frame - far.first_y, 0, far.height);
  };
  const MarchScene& overview = sent.far->scene;
  add(overview, sent.overview_light->sent, {0, 0, far.width, far_row(sent.lit.y0)}, &far);
  add(overview, sent.overview_light->sent, {0, far_row(sent.lit.y1), far.width, far.height}, &far);
  return parts;
}

/// The index in Emitters::points of the k-th of all points.
class Order {
 public:
  explicit Order(unsigned seed) {
    for (int m = 0; m < Interleaving::kMembers; ++m) {
      const glm::vec2 u = sobol_point(std::uint32_t(SlicePattern::rank(m)), hash_of(seed, 0, 7));
      members_[std::size_t(int(u.x * Interleaving::kMembers))] = m;
    }
  }
  std::size_t place(std::size_t k) const {
    const auto member = std::size_t(members_[k % Interleaving::kMembers]);
    return member * Emitters::kPoints + k / Interleaving::kMembers;
  }

 private:
  std::array<int, Interleaving::kMembers> members_{};
};

/// Spreads points over the power of everything that sends, which comes tile by tile.
class Points {
 public:
  Points(double power, const Order& order, Emitters& out)
      : order_(order), each_(power / double(out.points.size())), out_(out) {}

  /// Takes the sides of a tile; `before`: the power of all tiles before it.
  template <class ForEachSide>
  void add(double before, double power, const ForEachSide& for_each_side) const {
    auto next = std::size_t(std::max(0.0, std::ceil(before / each_ - 0.5)));
    const auto end = std::min(
        out_.points.size(), std::size_t(std::max(0.0, std::ceil((before + power) / each_ - 0.5))));
    double reached = before;
    const auto take = [&](const Side& s) {
      Emitter& point = out_.points[order_.place(next++)];
      point = s.point;
      // As much power as every other point has, in the colour of this one.
      const double times = each_ * Interleaving::kMembers / s.power();
      point.power *= float(times), point.area *= float(times);
      point.per_radiance *= float(times);
    };
    const Side* last = nullptr;
    Side kept;
    for_each_side([&](const Side& s) {
      reached += s.power();
      kept = s, last = &kept;
      while (next < end && (double(next) + 0.5) * each_ < reached) take(s);
    });
    while (last && next < end) take(*last);  // rounding
  }

 private:
  const Order& order_;
  double each_;
  Emitters& out_;
};

}  // namespace

Emitters find_emitters(const SentLight& sent, unsigned seed) {
  Emitters out;
  const BrightLevel bright = bright_level(sent);
  out.bright = bright.bright, out.level = bright.level;
  if (std::isinf(out.level)) return out;
  const std::vector<Part> parts = parts_of(sent, out.level);
  std::vector<std::vector<double>> power;
  double all = 0;
  for (const Part& part : parts) {
    std::vector<double> of_part(part.tiles.count());
    for_each_task(of_part.size(), [&](std::size_t tile) {
      double sum = 0;
      part.for_each_side(tile, [&](const Side& s) { sum += s.power(); });
      of_part[tile] = sum;
    });
    for (const double of_tile : of_part) all += of_tile;
    power.push_back(std::move(of_part));
  }
  if (!(all > 0)) return out;
  out.points.resize(std::size_t(Interleaving::kMembers * Emitters::kPoints));
  out.power = float(all / Emitters::kPoints);
  const Order order(seed);
  const Points points(all, order, out);
  double before = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    std::vector<double> starts;
    for (const double of_tile : power[k]) starts.push_back(before), before += of_tile;
    for_each_task(starts.size(), [&](std::size_t tile) {
      if (power[k][tile] > 0) {
        points.add(starts[tile], power[k][tile],
                   [&](const auto& visit) { parts[k].for_each_side(tile, visit); });
      }
    });
  }
  return out;
}

Emitters emitters_of_light(Emitters of_all, const InterleavedVectors& radiance, bool two_sided,
                           const OverviewLight* far) {
  bool sends = false;
  for (Emitter& e : of_all.points) {
    const InterleavedVectors& from = e.is_far ? far->sent : radiance;
    const glm::vec3 both(from[0][e.pixel], from[1][e.pixel], from[2][e.pixel]);
    const auto side = e.is_back ? unpack_bf16_second : unpack_bf16_first;
    e.power = e.per_radiance * (two_sided ? each(side, both) : both);
    sends = sends || e.power != glm::vec3(0);
  }
  if (!sends) of_all.points.clear();
  return of_all;
}

}  // namespace ssdo
