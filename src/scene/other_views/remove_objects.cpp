// SPDX-License-Identifier: Apache-2.0
//
// Objects that cast nothing are taken out of a frame. No pixel shows what is behind them, so each
// pixel of the hole gets, in this order,
//
// - what another view shows on its view ray, behind the object,
// - what the surfaces around the hole suggest. Four lines run through the pixel, and each ends in
//   two pixels beside the hole. If both show one plane, the pixel gets this plane, whose 1/z is
//   linear along the line. Else the surface at each end continues on its tangent plane, or as
//   background. Guesses weigh as 1 over the squared distance in pixels, and those that agree count
//   together. So a floor continues below a thing that stands on it, and a wall behind it.
//
// Where two guesses are of surfaces that meet in a corner, the nearer one is seen.
//
// A guess may not lie before the object: it would have hidden the object.
//
// A surface is continued by twice the length that is seen of it in this direction. Beyond that its
// weight falls, again by the square of the distance: a thing that rests on the object, or ends
// beside it, is not continued below it.
//
// If the geometry is only some rows of a frame, a line may leave these rows before it finds an end.
// The filled hole of the overview then gives the guess, at the distance of the last row.
//
// covered_pixels() decides which pixels show the object: a rim that is left behind would cast as a
// sheet.
#include "scene/other_views/remove_objects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <utility>

#include "math/pixel_grid.h"
#include "math/whole_division.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/other_views/covered_pixels.h"

namespace ssdo {
namespace {

/// Two ends of a line show one plane if their normals agree and each end lies off the other's
/// tangent plane by at most this share of the distance between them.
constexpr float kOnePlane = 0.05f;

/// Guesses agree if their depths differ by less than this share, and they have one normal.
constexpr float kSameDepth = 0.03f;

/// Guesses with less than this share of the weight of the best one are ignored at corners.
constexpr float kSecond = 0.1f;

/// A surface is continued by kGoesOn times the length that is seen of it, and without limit once
/// this gives kFollowed pixels.
constexpr float kGoesOn = 2, kFollowed = 256;

/// A guess is background if the pixel's view ray meets the tangent plane at more than this many
/// times the depth of the pixel that suggests it.
constexpr float kFarthestMet = 50;

struct Step {
  int dx, dy;
};
constexpr std::array<Step, 8> kWays = {
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, 1}, {1, -1}, {-1, 1}}};

constexpr int kNone = -1;

/// A surface, or background, that may fill a pixel of the hole.
struct Guess {
  float nearness = 0;  ///< 1/z, or z where the camera is orthographic; not for background
  bool is_background = false;
  float weight = 0;
  int end = kNone;  ///< the pixel that suggests it, or the nearer of two; kNone: the overview does
  glm::vec3 normal{0};
};

class Hole {
 public:
  Hole(const Geometry& geometry, const Plane<float>& coverage, const Plane<float>& backdrop,
       const Geometry* overview)
      : shown_(geometry),
        overview_(geometry.part_of ? overview : nullptr),
        casting_{
            geometry, Plane<int>(geometry.surfaces.width, geometry.surfaces.height, kNone), {}},
        is_open_(covered_pixels(geometry.surfaces, geometry.camera, coverage)) {
    for (std::size_t i = 0; i < backdrop.size(); ++i)
      if (backdrop[i] > 0) casting_.geometry.surfaces.set(i, Surfel());
  }

  CasterSurfaces fill(const std::vector<OtherView>& views) {
    const Ends of_frame = find_ends(0);
    for (const OtherView& view : views) add(view);
    const Ends more = views.empty() ? Ends() : find_ends(kMeasured);
    const Ends& ends = views.empty() ? of_frame : more;
    for_each_row(is_open_.height, [&](int y) {
      for (int x = 0; x < is_open_.width; ++x) {
        const std::size_t i = is_open_.index(x, y);
        if (is_open_[i] == kUnknown) guess(x, y, at(ends, i));
        if (is_open_[i] && casting_.geometry.surfaces[i].is_surface())
          casting_.sender[i] = sender(x, y, casting_.sender[i], at(of_frame, i));
      }
    });
    casting_.hole = std::move(is_open_);
    for (unsigned char& open : casting_.hole.pixels) open = open != 0;
    return std::move(casting_);
  }

 private:
  /// The nearest pixel that is known, in each direction of every pixel.
  using Ends = std::array<Plane<int>, kWays.size()>;
  using EndsOfPixel = std::array<int, kWays.size()>;

  static constexpr unsigned char kUnknown = 1, kMeasured = 2;

  static EndsOfPixel at(const Ends& ends, std::size_t pixel) {
    EndsOfPixel out;
    for (std::size_t k = 0; k < kWays.size(); ++k) out[k] = ends[k][pixel];
    return out;
  }

  /// The pixel of the frame whose light a filled pixel sends: `end` if it is outside the hole, else
  /// the nearest surface beside the hole.
  int sender(int x, int y, int end, const EndsOfPixel& ends) const {
    if (end != kNone && !is_open_[std::size_t(end)]) return end;
    int nearest = kNone;
    for (const int each : ends) {
      if (each == kNone || !known(each).is_surface()) continue;
      if (nearest == kNone || distance_px(x, y, each) < distance_px(x, y, nearest)) nearest = each;
    }
    return nearest;
  }

  float nearness_of(const glm::vec3& p) const {
    return shown_.camera.orthographic ? -p.z : -1 / p.z;
  }

  glm::vec3 place(int x, int y, float nearness) const {
    const double depth = shown_.camera.orthographic ? double(nearness) : 1 / double(nearness);
    return glm::vec3(
        shown_.camera.unproject({shown_.window.x0 + x + 0.5, shown_.window.y0 + y + 0.5}, depth));
  }

  /// Whether something at this depth would have been hidden by the object.
  bool is_behind(int x, int y, float depth) const {
    const Surfel& s = shown_.surfaces(x, y);
    return !s.is_surface() || depth >= -s.position.z;
  }

  /// Fills pixels with what another view shows behind the object; the nearest of several points.
  void add(const OtherView& view) {
    const Surfaces seen = view.surfels_in_frame();
    const bool ortho = shown_.camera.orthographic;
    for (const Surfel& s : seen) {
      if (!s.is_usable() || glm::dot(s.normal, direction_to_viewer(s.position, ortho)) <= 0)
        continue;
      const glm::dvec2 at = shown_.camera.project(glm::dvec3(s.position));
      const double px = std::floor(at.x - shown_.window.x0),
                   py = std::floor(at.y - shown_.window.y0);
      if (!(px >= 0 && py >= 0 && px < is_open_.width && py < is_open_.height)) continue;
      const std::size_t i = is_open_.index(int(px), int(py));
      const bool is_filled = is_open_[i] == kMeasured;
      if (!is_open_[i] || !is_behind(int(px), int(py), -s.position.z)) continue;
      Surfaces& casting = casting_.geometry.surfaces;
      if (is_filled && casting.position[2][i] >= s.position.z) continue;
      casting.set(i, s);
      is_open_[i] = kMeasured;
    }
  }

  /// Finds the ends for all pixels. Pixels of the hole with the mark `known` count as known too.
  Ends find_ends(unsigned char known) const {
    Ends ends;
    for_each_task(kWays.size(), [&](std::size_t k) {
      const auto [dx, dy] = kWays[k];
      Plane<int>& nearest = ends[k] = Plane<int>(is_open_.width, is_open_.height, kNone);
      const int w = is_open_.width, h = is_open_.height;
      const bool back_x = dx > 0, back_y = dy > 0;
      for (int row = 0; row < h; ++row) {
        const int y = back_y ? h - 1 - row : row;
        for (int column = 0; column < w; ++column) {
          const int x = back_x ? w - 1 - column : column, nx = x + dx, ny = y + dy;
          const std::size_t i = is_open_.index(x, y);
          if (!is_open_[i] || is_open_[i] == known)
            nearest[i] = int(i);
          else if (nx >= 0 && ny >= 0 && nx < w && ny < h)
            nearest[i] = nearest(nx, ny);
        }
      }
    });
    return ends;
  }

  float distance_px(int x, int y, int end) const {
    const int w = is_open_.width;
    return std::hypot(float(end % w - x), float(end / w - y));
  }

  /// The distance, in pixels, by which the surface at an end is expected to continue; at most
  /// `away`.
  float goes_on(int end, const Step& way, float away) const {
    const int w = is_open_.width, x = end % w, y = end / w;
    const Surfel& s = known(end);
    float on = kGoesOn;
    for (int k = 1; on < std::min(away, kFollowed); ++k, on += kGoesOn) {
      const int nx = x + k * way.dx, ny = y + k * way.dy;
      // The border or the hole hides where the surface ends.
      if (nx < 0 || ny < 0 || nx >= w || ny >= is_open_.height || is_open_(nx, ny)) return away;
      const Surfel& q = shown_.surfaces(nx, ny);
      if (!q.is_surface() || glm::dot(q.normal, s.normal) < kOneNormal) return on;
      const glm::vec3 to = q.position - s.position;
      if (std::abs(glm::dot(to, s.normal)) > kOnePlane * glm::length(to)) return on;
    }
    return away;
  }

  Surfel known(int end) const { return casting_.geometry.surfaces[std::size_t(end)]; }

  /// The guess from one end alone: its tangent plane on the view ray of a pixel. `way` points away
  /// from the hole.
  Guess alone(int x, int y, int end, const Step& way) const {
    const Surfel& s = known(end);
    const float away = distance_px(x, y, end);
    Guess guess = on_plane_of(s, x, y, away);
    guess.end = end;
    if (guess.is_background || guess.weight == 0) return guess;
    const float on = std::min(1.0f, goes_on(end, way, away) / away);
    guess.weight *= on * on;
    return guess;
  }

  /// The guess from the overview at a pixel, for a line that leaves the rows after `away` pixels.
  Guess in_overview(int x, int y, float away) const {
    const Geometry& small = *overview_;
    const auto block = [](int pixel, int first, int first_small, int size) {
      return std::clamp(floor_divide(pixel - first, kOverviewStride) - first_small, 0, size - 1);
    };
    const int column = block(shown_.window.x0 + x, shown_.display.x0, small.window.x0,
                             small.surfaces.width),
              row = block(shown_.window.y0 + y, shown_.display.y0, small.window.y0,
                          small.surfaces.height);
    return on_plane_of(small.surfaces(column, row), x, y, away);
  }

  /// The distance, in pixels, at which a line leaves these rows for others of the frame; 0 if it
  /// does not.
  float leaves_rows(int y, const Step& way) const {
    if (!overview_ || way.dy == 0) return 0;
    const bool goes_on =
        way.dy < 0 ? shown_.window.y0 > shown_.part_of->y0 : shown_.window.y1 < shown_.part_of->y1;
    const int rows = way.dy < 0 ? y + 1 : is_open_.height - y;
    return goes_on ? float(rows) * std::hypot(float(way.dx), 1.0f) : 0;
  }

  /// The guess from the tangent plane of `s`, `away` pixels from here, on the view ray of a pixel.
  Guess on_plane_of(const Surfel& s, int x, int y, float away) const {
    Guess guess{0, !s.is_surface(), 1 / (away * away), kNone, s.normal};
    if (s.is_broken()) guess.weight = 0;
    if (guess.is_background || guess.weight == 0) return guess;
    const auto [origin, direction] =
        shown_.camera.ray({shown_.window.x0 + x + 0.5, shown_.window.y0 + y + 0.5});
    const double per = glm::dot(glm::dvec3(s.normal), direction),
                 depth = glm::dot(glm::dvec3(s.normal), glm::dvec3(s.position) - origin) / per,
                 own = -double(s.position.z);
    if (!(per < 0) || !(depth > 0)) {
      guess.weight = 0;  // the ray does not meet its front
    } else if (depth > double(kFarthestMet) * own) {
      guess.is_background = true;
    } else {
      guess.nearness = shown_.camera.orthographic ? float(depth) : float(1 / depth);
    }
    return guess;
  }

  /// The guess between two ends that show one plane; weight 0 if they do not.
  Guess between(int x, int y, int a, int b) const {
    const Surfel &s = known(a), &t = known(b);
    if (!s.is_surface() || !t.is_surface() || glm::dot(s.normal, t.normal) < kOneNormal) return {};
    const glm::vec3 way = t.position - s.position;
    const float off =
        std::max(std::abs(glm::dot(way, s.normal)), std::abs(glm::dot(way, t.normal)));
    if (off > kOnePlane * glm::length(way)) return {};
    const float to_a = distance_px(x, y, a), to_b = distance_px(x, y, b),
                share = to_a / (to_a + to_b);
    return {std::lerp(nearness_of(s.position), nearness_of(t.position), share), false,
            1 / (to_a * to_a) + 1 / (to_b * to_b), to_a <= to_b ? a : b,
            glm::normalize(glm::mix(s.normal, t.normal, share))};
  }

  void guess(int x, int y, const EndsOfPixel& ends) {
    std::array<Guess, kWays.size()> guesses;
    std::size_t count = 0;
    const auto take = [&](const Guess& one) {
      const float depth = shown_.camera.orthographic ? one.nearness : 1 / one.nearness;
      if (one.weight > 0 && (one.is_background || is_behind(x, y, depth))) guesses[count++] = one;
    };
    for (std::size_t k = 0; k < kWays.size(); k += 2) {
      const int a = ends[k], b = ends[k + 1];
      const Guess both = a != kNone && b != kNone ? between(x, y, a, b) : Guess();
      if (both.weight > 0) {
        take(both);
        continue;
      }
      for (const std::size_t way : {k, k + 1}) {
        if (ends[way] != kNone)
          take(alone(x, y, ends[way], kWays[way]));
        else if (const float away = leaves_rows(y, kWays[way]); away > 0)
          take(in_overview(x, y, away));
      }
    }
    put(x, y, {guesses.data(), count});
  }

  static bool agree(const Guess& a, const Guess& b) {
    if (a.is_background || b.is_background) return a.is_background && b.is_background;
    return glm::dot(a.normal, b.normal) > kOneNormal &&
           std::abs(a.nearness - b.nearness) <= kSameDepth * std::max(a.nearness, b.nearness);
  }

  static float weight_of(const Guess& guess, std::span<const Guess> all) {
    float weight = 0;
    for (const Guess& other : all) weight += agree(guess, other) ? other.weight : 0.0f;
    return weight;
  }

  /// Where two surfaces meet in a corner, each before the other's plane, the nearer one is seen.
  const Guess* nearer_of_corner(const Guess& best, float most, std::span<const Guess> all) const {
    const Guess* nearest = &best;
    if (best.end == kNone) return nearest;
    const Surfel& s = known(best.end);
    for (const Guess& other : all) {
      if (other.is_background || other.end == kNone || weight_of(other, all) < kSecond * most)
        continue;
      const Surfel& t = known(other.end);
      const glm::vec3 way = t.position - s.position;
      const bool is_corner = glm::dot(way, s.normal) > 0 && glm::dot(way, t.normal) < 0;
      const bool is_nearer = shown_.camera.orthographic ? other.nearness < nearest->nearness
                                                        : other.nearness > nearest->nearness;
      if (is_corner && is_nearer) nearest = &other;
    }
    return nearest;
  }

  void put(int x, int y, std::span<const Guess> guesses) {
    Surfel out;
    const Guess* best = nullptr;
    float most = 0;
    for (const Guess& one : guesses) {
      const float weight = weight_of(one, guesses);
      if (weight > most) most = weight, best = &one;
    }
    if (!best || best->is_background) {
      if (!best) out.rounding = Surfel::kBroken;  // nothing tells what is there
      casting_.geometry.surfaces.set(x, y, out);
      return;
    }
    best = nearer_of_corner(*best, most, guesses);
    double nearness = 0, weights = 0;
    glm::vec3 normal(0);
    const Guess* nearest = best;
    for (const Guess& one : guesses) {
      if (!agree(*best, one)) continue;
      nearness += double(one.weight) * double(one.nearness), weights += double(one.weight);
      normal += one.weight * one.normal;
      if (one.weight > nearest->weight) nearest = &one;
    }
    out.position = place(x, y, float(nearness / weights));
    out.normal = glm::normalize(normal);
    out.rounding = nearest->end == kNone ? 0 : known(nearest->end).rounding;
    casting_.geometry.surfaces.set(x, y, out);
    casting_.sender(x, y) = nearest->end;
  }

  const Geometry& shown_;
  const Geometry* const overview_;  ///< null: these are all rows
  CasterSurfaces casting_;
  Plane<unsigned char> is_open_;  ///< kUnknown in the hole, kMeasured where another view shows it
};

}  // namespace

CasterSurfaces remove_objects(const Geometry& geometry, const Plane<float>& coverage,
                              const Plane<float>& backdrop, const std::vector<OtherView>& views,
                              const Geometry* overview) {
  return Hole(geometry, coverage, backdrop, overview).fill(views);
}

}  // namespace ssdo
