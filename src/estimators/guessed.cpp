// SPDX-License-Identifier: Apache-2.0
#include "estimators/guessed.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "estimators/bitmask/slice_pattern.h"
#include "estimators/other_views/other_view_rays.h"
#include "estimators/ray_start.h"
#include "math/frame.h"
#include "math/infinity.h"
#include "math/sampling.h"
#include "math/sobol.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/other_views/sight.h"
#include "scene/pixel_footprint.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

/// Rays per pixel where a filter averages neighbours, and per pixel where mean_guessed() skips
/// most.
constexpr int kRays = 2, kRaysOfMean = 8;

/// About how many pixels, evenly spread, mean_guessed() takes: the mean is then within 0.01.
constexpr int kPixelsOfMean = 1024;

/// Number of places along a ray that are compared with the frame, from one pixel away to the
/// frame's diagonal; their spacing grows with the distance.
constexpr int kSteps = 24;

/// Beyond the frame: the ratio of the distances of successive places, and their largest distance
/// over that of the farthest surface.
constexpr float kGrowth = 1.3f, kFarthest = 4;

/// Rays with a larger cosine to the direction to the viewer leave the frame behind the camera.
constexpr float kTowardsCamera = 0.5f;

constexpr std::uint32_t kSeed = 0x6e55;

/// A ray and its projection: a straight line, which starts at `from` and leads along `way`, a unit
/// vector, y down. The place `r` pixels along it shows the point of the ray at the length r w /
/// (speed - r away).
struct PicturedRay {
  glm::vec3 origin, to;
  glm::vec2 from, way;
  float w, away, speed;
  float most;  ///< length of the ray

  float length_at(float r) const {
    const float left = speed - r * away;
    return left > 0 ? std::min(r * w / left, most) : most;
  }
  float pixels_at(float length) const {
    return std::isinf(length) ? speed / away : speed * length / (w + away * length);
  }
  glm::vec3 point(float length) const { return origin + length * to; }
};

}  // namespace

/// Follows rays over the pictures, to the first place that none of them shows.
class RayFollower {
 public:
  RayFollower(const Scene& scene, float radius)
      : scene_(scene),
        surfaces_(scene.geometry.surfaces),
        casting_(scene.casters().surfaces),
        footprint_(scene.geometry.camera),
        radius_(radius),
        other_views_(OtherViewRays::of_added(scene.other_surfaces)) {
    const Camera& camera = scene.geometry.camera;
    f_ = {float(camera.fx), float(camera.fy)};
    c_ = {float(camera.cx - scene.geometry.window.x0), float(camera.cy - scene.geometry.window.y0)};
    far_ = scene.views.empty() ? radius : std::min(radius, kFarthest * farthest_surface());
    const float diagonal = std::hypot(float(surfaces_.width), float(surfaces_.height));
    for (std::size_t i = 0; i < distances_.size(); ++i)
      distances_[i] =
          std::pow(diagonal, std::pow((float(i) + 0.5f) / float(distances_.size()), kCloser));
  }

  /// Copies the depths from the surfels into a plane of their own: faster if many rays follow.
  void gather_depths() {
    Plane<float> depth = Plane<float>::like(surfaces_);
    for (std::size_t i = 0; i < depth.size(); ++i) depth[i] = depth_at(i);
    depth_ = std::move(depth);
  }

  /// The points of a sequence that give the rays of a pixel.
  struct Samples {
    int first, count;
    std::uint32_t seed;
  };

  /// All pixels of a window as large as the pattern together cover the hemisphere evenly.
  Samples samples_at(int x, int y, unsigned seed) const {
    constexpr int kPeriod = kGuessedPattern;
    static_assert(kPeriod == Interleaving::kPeriod);
    const Window &window = scene_.geometry.window, &display = scene_.geometry.display;
    const int column = (window.x0 - display.x0 + x) & (kPeriod - 1),
              row = (window.y0 - display.y0 + y) & (kPeriod - 1);
    return {SlicePattern::rank(row * kPeriod + column) * kRays, kRays, hash_of(seed, 0, kSeed)};
  }

  /// Calls on_guessed(place) with the first unseen place that each guessed ray of a pixel passed.
  template <class OnGuessed>
  void gather(int x, int y, const Samples& samples, const OnGuessed& on_guessed) const {
    const std::size_t pixel = surfaces_.index(x, y);
    const glm::mat3 frame = frame_about(surfaces_[pixel].normal);
    for (int k = samples.first; k < samples.first + samples.count; ++k) {
      const auto unseen = first_unseen(
          pixel, cosine_direction(frame, sobol_point(std::uint32_t(k), samples.seed)), k);
      if (unseen) on_guessed(*unseen);
    }
  }

  /// The first unseen place that the k-th ray of a pattern passed, if it is guessed.
  std::optional<Unseen> first_unseen(std::size_t pixel, const glm::vec3& to, int k) const {
    const Surfel& s = surfaces_[pixel];
    const float above =
        kAboveRoundings * s.rounding + kAboveFootprints * footprint_.at(-s.position.z);
    const glm::vec3 to_viewer =
        direction_to_viewer(s.position, scene_.geometry.camera.orthographic);
    return follow(pictured(s.position + above * s.normal, to), s.normal, k * kSpread,
                  glm::dot(to, to_viewer) > kTowardsCamera);
  }

 private:
  /// Exponent that crowds the places towards the start of a ray; the number of sets of places,
  /// which differ in their distances; and the step from the set of one ray to that of the next.
  static constexpr float kCloser = 0.7f;
  static constexpr int kSets = 16, kSpread = 5;

  /// Whether a pixel shows a surface that casts nothing: the view ray is free up to that surface,
  /// and no pixel shows what is behind it.
  bool is_hole(std::size_t pixel) const {
    return scene_.caster_surfaces && scene_.caster_surfaces->hole[pixel] != 0;
  }

  /// The surface at which the view ray of a pixel ends.
  Surfel shown(std::size_t pixel) const {
    return is_hole(pixel) ? surfaces_[pixel] : casting_[pixel];
  }

  /// Depth along the view axis; infinite where no surface is shown.
  float depth_at(std::size_t pixel) const {
    if (!depth_.empty()) return depth_[pixel];
    const Surfel& s = shown(pixel);
    return s.is_usable() ? -s.position.z : kInfinity;
  }

  /// Distance to the viewer of the farthest surface.
  float farthest_surface() const {
    float farthest = 0;
    for (const Surfel& s : surfaces_)
      if (s.is_usable()) farthest = std::max(farthest, glm::length(s.position));
    return farthest;
  }

  PicturedRay pictured(const glm::vec3& origin, const glm::vec3& to) const {
    const bool orthographic = scene_.geometry.camera.orthographic;
    PicturedRay line{origin, to,     {}, {}, orthographic ? 1 : -origin.z, orthographic ? 0 : -to.z,
                     0,      radius_};
    const glm::vec2 at(origin.x, -origin.y), along(to.x, -to.y);
    line.from = c_ + f_ * at / line.w;
    const glm::vec2 moves = f_ * (along * line.w - at * line.away) / line.w;
    line.speed = glm::length(moves);
    line.way = line.speed > 0 ? moves / line.speed : glm::vec2(1, 0);
    return line;
  }

  /// Where a ray leaves the frame: the pixels along its projection up to there, and the side.
  std::pair<float, Unseen> leaves(const PicturedRay& line) const {
    const auto crosses = [](float from, float way, float size) {
      return way > 0 ? (size - from) / way : way < 0 ? from / -way : kInfinity;
    };
    const float across = crosses(line.from.x, line.way.x, float(surfaces_.width)),
                down = crosses(line.from.y, line.way.y, float(surfaces_.height));
    if (across < down) return {across, line.way.x > 0 ? Unseen::right : Unseen::left};
    return {down, line.way.y > 0 ? Unseen::bottom : Unseen::top};
  }

  std::size_t pixel_at(const PicturedRay& line, float r) const {
    const glm::vec2 at = line.from + r * line.way;
    // Not-a-number, of a point in the camera's own plane, is pixel 0.
    const auto whole = [](float x, int size) {
      return x > 0 ? int(std::min(x, float(size - 1))) : 0;
    };
    return surfaces_.index(whole(at.x, surfaces_.width), whole(at.y, surfaces_.height));
  }

  /// How far, along the view axis, a ray at `r` lies behind the surface that its pixel shows; 0 if
  /// it is in front, or if that surface lies below the receiver's tangent plane.
  float behind_front(const PicturedRay& line, float r, const glm::vec3& normal) const {
    const std::size_t pixel = pixel_at(line, r);
    const float behind = -line.origin.z - line.length_at(r) * line.to.z - depth_at(pixel);
    if (!(behind > 0)) return 0;
    return glm::dot(shown(pixel).position - line.origin, normal) > 0 ? behind : 0;
  }

  /// Whether a ray that is in front of what the picture shows at `before` and behind it at `after`
  /// meets that surface in between, and does not slip behind its edge.
  bool meets(const PicturedRay& line, float before, float after, const glm::vec3& normal) const {
    while (after - before > 1) {
      const float middle = 0.5f * (before + after);
      (behind_front(line, middle, normal) > 0 ? after : before) = middle;
    }
    if (is_hole(pixel_at(line, after))) return false;
    const Surfel &a = shown(pixel_at(line, before)), &b = shown(pixel_at(line, after));
    if (a.is_usable() && on_one_surface({a.position, a.normal}, {b.position, b.normal}, footprint_))
      return true;
    // Within a pixel the ray crosses the plane of what is seen there, and not far from it.
    const float gap = kSurfaceGap * footprint_.at(-b.position.z);
    const glm::vec3 from = line.point(line.length_at(before)) - b.position,
                    to = line.point(line.length_at(after)) - b.position;
    const float above = glm::dot(from, b.normal), below = -glm::dot(to, b.normal);
    if (above < 0 || below < -gap) return false;
    const float share = above / std::max(above + below, above);
    return glm::distance(from + share * (to - from), glm::vec3(0)) <= gap;
  }

  /// Whether the place on the view ray of a pixel that lies `behind` its surface, along the view
  /// axis, is within a solid whose front and back other pictures have measured.
  bool is_in_measured_solid(std::size_t pixel, float behind) const {
    if (is_hole(pixel)) return false;  // solids are of what stands there in its place
    const Solids& solids = scene_.solids;
    const glm::vec3& p = surfaces_[pixel].position;
    const float distance =
        scene_.geometry.camera.orthographic ? behind : behind * glm::length(p) / -p.z;
    if (solids.end_is_measured(pixel) && distance <= solids.thickness[pixel]) return true;
    for (int k = 1; k < solids.layers(); ++k) {
      const Solid solid = solids.at(k, pixel);
      if (solids.provenance(k, pixel) == Provenance::measured && distance >= solid.distance &&
          distance <= solid.distance + solid.thickness)
        return true;
    }
    return false;
  }

  /// What the other views know about a ray.
  std::vector<SightLine> sights(const PicturedRay& line) const {
    std::vector<SightLine> all;
    for (const OtherView& view : scene_.views) all.emplace_back(view, line.origin, line.to);
    return all;
  }

  static bool one_shows(const std::vector<SightLine>& views, float length) {
    return std::any_of(views.begin(), views.end(),
                       [&](const SightLine& view) { return view.at(length) != Sight::unknown; });
  }

  /// The first place on a ray that no picture shows; none if the ray meets a surface that is shown.
  std::optional<Unseen> follow(const PicturedRay& line, const glm::vec3& normal, int set,
                               bool to_camera) const {
    if (other_views_ && other_views_->is_blocked(line.origin, line.to, radius_))
      return std::nullopt;
    const auto [border, side] = leaves(line);
    const float whole =
        line.most < kInfinity || line.away > 0 ? line.pixels_at(line.most) : kInfinity;
    const bool stays = whole > 0 && whole <= border;
    const float end = stays ? whole : border;
    const std::vector<SightLine> views = sights(line);
    std::optional<Unseen> unseen;
    float before = 0;
    bool in_front = true;
    for (int i = 0; i <= kSteps; ++i) {
      const float r = i < kSteps
                          ? std::min(distances_[std::size_t(i * kSets + (set & (kSets - 1)))], end)
                          : end;
      const float behind = behind_front(line, r, normal);
      if (behind > 0) {
        if (in_front && meets(line, before, r, normal)) return std::nullopt;
        if (is_in_measured_solid(pixel_at(line, r), behind)) return std::nullopt;
        in_front = false;
        if (!unseen && !one_shows(views, std::min(line.length_at(r), far_)))
          unseen = Unseen::behind_things;
      } else {
        in_front = true;
        before = r;
      }
      if (r >= end) break;
    }
    if (unseen || stays || !shown(pixel_at(line, end - 0.5f)).is_usable()) return unseen;
    const Unseen out = to_camera ? Unseen::behind_camera : side;
    if (scene_.views.empty()) return out;
    const float start = line.length_at(border);
    for (float length = std::max(start, footprint_.at(line.w)); length < far_; length *= kGrowth)
      if (!one_shows(views, length)) return out;
    return std::nullopt;
  }

  const Scene& scene_;
  const Surfaces& surfaces_;  ///< what receives
  const Surfaces& casting_;   ///< what casts
  Plane<float> depth_;        ///< depth_at() of all pixels; empty: not gathered
  PixelFootprint footprint_;
  float radius_, far_;
  std::unique_ptr<OtherViewRays> other_views_;  ///< null: there are no other views
  glm::vec2 f_, c_;
  std::array<float, std::size_t(kSteps* kSets)> distances_;
};

GuessedRays::GuessedRays(const Scene& scene, float radius) {
  auto rays = std::make_unique<RayFollower>(scene, radius);
  rays->gather_depths();
  rays_ = std::move(rays);
}

GuessedRays::~GuessedRays() = default;

bool GuessedRays::is_guessed(std::size_t pixel, const glm::vec3& to, int k) const {
  return rays_->first_unseen(pixel, to, k).has_value();
}

Plane<float> guessed_shares(const Scene& scene, const Window& part, float radius, unsigned seed,
                            const Progress& progress) {
  RayFollower guesses(scene, radius);
  guesses.gather_depths();
  Plane<float> shares(part.width(), part.height(), 0.0f);
  for_each_tile(
      shares.width, shares.height,
      [&](const Tile& tile) {
        for (int y = tile.y0; y < tile.y1; ++y) {
          for (int x = tile.x0; x < tile.x1; ++x) {
            if (!scene.geometry.surfaces(part.x0 + x, part.y0 + y).is_usable()) continue;
            float sum = 0;
            const int px = part.x0 + x, py = part.y0 + y;
            guesses.gather(px, py, guesses.samples_at(px, py, seed), [&](Unseen at) {
              sum += at == Unseen::behind_things ? kGuessBehindThings : 1;
            });
            shares(x, y) = sum / kRays;
          }
        }
      },
      progress);
  return shares;
}

Plane<float> guessed_shares(const Scene& scene, const Plane<std::int32_t>& pixels,
                            const glm::ivec2& first, float radius, unsigned seed) {
  constexpr int kLast = kGuessedPattern - 1;
  RayFollower guesses(scene, radius);
  guesses.gather_depths();
  Plane<float> shares(pixels.width, pixels.height, 0.0f);
  for_each_tile(pixels.width, pixels.height, [&](const Tile& tile) {
    for (int y = tile.y0; y < tile.y1; ++y) {
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::int32_t pixel = pixels(x, y);
        if (pixel == kNoPixel) continue;
        const int width = scene.geometry.surfaces.width,
                  place = ((first.y + y) & kLast) * kGuessedPattern + ((first.x + x) & kLast);
        const RayFollower::Samples samples{SlicePattern::rank(place), 1, hash_of(seed, 0, kSeed)};
        guesses.gather(pixel % width, pixel / width, samples, [&](Unseen at) {
          shares(x, y) = at == Unseen::behind_things ? kGuessBehindThings : 1;
        });
      }
    }
  });
  return shares;
}

GuessedMean mean_guessed(const Scene& scene, float radius) {
  const RayFollower guesses(scene, radius);
  const Surfaces& surfaces = scene.geometry.surfaces;
  const Window &window = scene.geometry.window,
               shown = intersection(window, scene.geometry.display);
  const int apart = std::max(1, int(std::sqrt(double(shown.area()) / kPixelsOfMean)));
  const int first = shown.y0 - window.y0 + apart / 2, end = shown.y1 - window.y0;
  std::array<std::atomic<int>, kUnseenPlaces.size()> rays = {};
  std::atomic<int> points = 0;
  for_each_row(std::max(0, (end - first + apart - 1) / apart), [&](int row) {
    const int y = first + row * apart;
    for (int x = shown.x0 - window.x0 + apart / 2; x < shown.x1 - window.x0; x += apart) {
      if (!surfaces(x, y).is_usable()) continue;
      ++points;
      const RayFollower::Samples samples{0, kRaysOfMean,
                                         hash_of(std::uint32_t(x), std::uint32_t(y), kSeed)};
      guesses.gather(x, y, samples, [&](Unseen at) { ++rays[std::size_t(at)]; });
    }
  });
  if (points == 0) return {};
  GuessedMean mean;
  for (std::size_t place = 0; place < rays.size(); ++place) {
    mean.at[place] = float(rays[place]) / float(kRaysOfMean * points);
    mean.all += mean.at[place];
  }
  return mean;
}

}  // namespace ssdo
