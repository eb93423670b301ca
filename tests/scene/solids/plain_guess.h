// SPDX-License-Identifier: Apache-2.0
//
// What guess_solids() finds, run by run and in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <utility>

#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"
#include "scene/solids/connections.h"
#include "scene/solids/solids.h"
#include "scene/solids/width_of_run.h"

namespace ssdo::test {

/// The run of a direction through one pixel, end by end.
struct PlainRun {
  glm::ivec2 first{0}, last{0};
  int unknown_ends = 0;
  float depth = INFINITY;  ///< in the mean over its pixels
  double shown = 0;        ///< the part of it that the sides in view show, of a whole run

  int pixels() const {
    return 1 + std::max(std::abs(last.x - first.x), std::abs(last.y - first.y));
  }
  glm::ivec2 middle(const glm::ivec2& step) const { return first + pixels() / 2 * step; }
};

/// What the runs through one pixel say, each looked for anew.
class PlainGuess {
 public:
  PlainGuess(const Geometry& g, const Plane<unsigned char>& connections)
      : g_(g), connections_(connections), footprint_(g.camera) {
    for (std::size_t k = 0; k < kDirections.size(); ++k) {
      runs_[k] = Plane<PlainRun>(g.surfaces.width, g.surfaces.height);
      for (int y = 0; y < g.surfaces.height; ++y)
        for (int x = 0; x < g.surfaces.width; ++x)
          if (at({x, y})) runs_[k](x, y) = find_run({x, y}, k);
    }
    const auto as_wide = runs_;
    for (std::size_t k = 0; k < kDirections.size(); ++k)
      for (int y = 0; y < g.surfaces.height; ++y)
        for (int x = 0; x < g.surfaces.width; ++x)
          if (at({x, y}) && as_wide[k](x, y).unknown_ends == 0) {
            const auto [most, shown] = shown_depth({x, y}, k);
            runs_[k](x, y).depth = std::min(runs_[k](x, y).depth, most);
            runs_[k](x, y).shown = shown;
          }
  }

  static glm::ivec2 step(std::size_t k) { return {kDirections[k].dx, kDirections[k].dy}; }

  std::optional<Surfel> at(const glm::ivec2& p) const { return surface_at(g_.surfaces, p.x, p.y); }

  bool joined(const glm::ivec2& from, std::size_t k) const {
    return at(from) && connections_(from.x, from.y) >> k & 1;
  }

  const PlainRun& run(const glm::ivec2& p, std::size_t k) const { return runs_[k](p.x, p.y); }

  PlainRun find_run(const glm::ivec2& p, std::size_t k) const {
    PlainRun run{p, p};
    while (joined(run.first - step(k), k)) run.first -= step(k);
    while (joined(run.last, k)) run.last += step(k);
    const Surfel a = *at(run.first), b = *at(run.last);
    run.unknown_ends = goes_on(run.first - step(k), a) + goes_on(run.last + step(k), b);
    if (run.unknown_ends == 2) return run;
    const float width =
        glm::distance(a.position, b.position) +
        0.5f * step_px(k) * (footprint_.at(-a.position.z) + footprint_.at(-b.position.z));
    run.depth = kDepthOfWidth * width * (run.unknown_ends == 1 ? 3.0f : 1.0f);
    return run;
  }

  static float step_px(std::size_t k) { return k < 2 ? 1 : 1.41421356f; }

  float thickness(const glm::ivec2& p) const {
    float least = INFINITY;
    for (std::size_t k = 0; k < kDirections.size(); ++k)
      least = std::min(least, depth_across(p, k, mean_depth(p, k)));
    if (std::isinf(least)) return least;
    const double cosine = dot(normal(p), to_viewer(position(p)));
    return std::max(least, float(pixel(position(p)) * std::min(4.0, std::tan(std::acos(cosine)))));
  }

 private:
  /// Whether the surface of an end of a run may go on to a pixel that is not of it.
  bool goes_on(const glm::ivec2& to, const Surfel& end) const {
    const bool outside =
        to.x < 0 || to.y < 0 || to.x >= g_.surfaces.width || to.y >= g_.surfaces.height;
    return outside || (at(to) && at(to)->position.z > end.position.z);
  }

  /// Calls `visit(side, i, run, alike)` for the runs beside the one through a pixel.
  template <class Visit>
  void for_each_beside(const glm::ivec2& p, std::size_t k, int reach, const Visit& visit) const {
    const PlainRun& own = run(p, k);
    const bool whole = own.unknown_ends == 0;
    const std::size_t across = k ^ 1;
    for (const int side : {-1, 1}) {
      glm::ivec2 middle = own.middle(step(k));
      for (int i = 1; i <= reach; ++i) {
        const glm::ivec2 next = middle + side * step(across);
        if (!at(next) || !joined(side > 0 ? middle : next, across)) break;
        const PlainRun& beside = run(next, k);
        const double more = beside.pixels() - own.pixels(), less = beside.unknown_ends ? 0 : -more;
        double alike = std::min(1.0, (4 - less) / 3);
        alike = std::min(alike, whole && !beside.unknown_ends ? (4 - more) / 3
                                                              : 2 - more / (1.5 * own.pixels()));
        if (alike <= 0) break;
        middle = beside.middle(step(k));
        visit(side, i, beside, alike);
      }
    }
  }

  float mean_depth(const glm::ivec2& p, std::size_t k) const {
    const PlainRun& own = run(p, k);
    const bool whole = own.unknown_ends == 0;
    const int reach = (whole ? 1 : 4) * kWidthReach;
    double weights = whole ? 1 : 0.02, sum = weights / double(own.depth);
    for_each_beside(p, k, reach, [&](int, int i, const PlainRun& beside, double alike) {
      if (beside.unknown_ends) return;
      const double weight = alike * (1 - i / (reach + 1.0));
      weights += weight, sum += weight / double(beside.depth);
    });
    return float(weights / sum);
  }

  glm::dvec3 position(const glm::ivec2& p) const { return glm::dvec3(at(p)->position); }
  glm::dvec3 normal(const glm::ivec2& p) const { return glm::dvec3(at(p)->normal); }
  glm::dvec3 to_viewer(const glm::dvec3& p) const {
    return g_.camera.orthographic ? glm::dvec3(0, 0, 1) : -glm::normalize(p);
  }
  double pixel(const glm::dvec3& p) const { return double(footprint_.at(float(-p.z))); }

  /// What is seen beyond an end is so far behind the front that goes from `end` along `out`.
  double room(const glm::ivec2& beyond, const glm::dvec3& end, const glm::dvec3& out) const {
    if (!at(beyond)) return INFINITY;
    const glm::dvec3 view = to_viewer(end), back = view - glm::dot(view, out) * out;
    return glm::dot(end - position(beyond), glm::normalize(back));
  }

  using Ends = std::array<glm::dvec3, 2>;

  glm::dvec3 across_view(const PlainRun& own) const {
    const glm::dvec3 view = to_viewer(0.5 * (position(own.first) + position(own.last))),
                     way = position(own.last) - position(own.first);
    return glm::normalize(way - glm::dot(way, view) * view);
  }

  /// The silhouettes of a whole run, on the tangent planes of its ends.
  Ends silhouettes(const PlainRun& own, std::size_t k) const {
    const glm::ivec2 pixels[2] = {own.first, own.last};
    const glm::dvec3 across = across_view(own);
    Ends ends;
    for (const int e : {0, 1}) {
      const glm::dvec3 at_end = position(pixels[e]), n = normal(pixels[e]), v = to_viewer(at_end);
      const double aside = (e ? 0.5 : -0.5) * double(step_px(k)) * pixel(at_end);
      ends[std::size_t(e)] = at_end + aside * across -
                             aside * glm::dot(across, n) / std::max(glm::dot(n, v), 0.05) * v;
    }
    return ends;
  }

  /// How far behind `p` its view ray comes nearest to the line between the silhouettes.
  double to_chord(const glm::dvec3& p, const Ends& ends) const {
    const glm::dvec3 line = glm::normalize(ends[1] - ends[0]), ray = -to_viewer(p),
                     between = p - ends[0];
    const double cosine = glm::dot(line, ray);
    return (cosine * glm::dot(line, between) - glm::dot(ray, between)) / (1 - cosine * cosine);
  }

  /// The way from `p` on its view ray to the side that ends at a silhouette, at a right angle to
  /// the face with normal `n` in the section of the chord and the view ray.
  double to_side(const glm::dvec3& p, const glm::dvec3& n, const glm::dvec3& end,
                 const glm::dvec3& out) const {
    const glm::dvec3 ray = -to_viewer(p), section = glm::normalize(glm::cross(out, ray));
    glm::dvec3 m = glm::normalize(glm::cross(section, n));
    if (glm::dot(m, out) < 0) m = -m;
    const double heads = glm::dot(ray, m);
    return heads > 0 ? std::max(glm::dot(end - p, m), 0.0) / heads : INFINITY;
  }

  /// The depth at a pixel of a run whose mean depth is `mean`: the shown half, turned about the
  /// middle, and hidden sides at right angles.
  float depth_across(const glm::ivec2& p, std::size_t k, float mean) const {
    const PlainRun& own = run(p, k);
    if (own.unknown_ends != 0 || own.pixels() == 1 || std::isinf(mean)) return mean;
    const Ends ends = silhouettes(own, k);
    const glm::ivec2 counterpart = own.first + own.last - p;
    const glm::dvec3 chord = ends[1] - ends[0];
    const double turned = to_chord(position(p), ends) + to_chord(position(counterpart), ends),
                 hidden = std::min(to_side(position(p), normal(own.first), ends[0], -chord),
                                   to_side(position(p), normal(own.last), ends[1], chord)),
                 most = double(mean);
    return float(std::max(turned, 0.0) * (own.shown > most ? most / own.shown : 1) +
                 std::min(std::max(most - own.shown, 0.0), hidden));
  }

  /// Of a whole run: twice the area under it over its width, and half a pixel of a side; and the
  /// first of these alone.
  std::pair<float, double> shown_depth(const glm::ivec2& p, std::size_t k) const {
    const PlainRun& own = run(p, k);
    if (own.pixels() == 1) return {INFINITY, 0};
    glm::dvec3 edges[2] = {};
    int lines = 0;
    PlainRun farthest[2] = {own, own};
    for_each_beside(p, k, kWidthReach, [&](int side, int, const PlainRun& beside, double) {
      farthest[side > 0] = beside, ++lines;
    });
    const glm::ivec2 pixels[2] = {own.first, own.last};
    const glm::dvec3 view = to_viewer(0.5 * (position(own.first) + position(own.last)));
    const Ends ends = silhouettes(own, k);
    // Trapezoids over the chord.
    const glm::dvec3 chord = ends[1] - ends[0], along = glm::normalize(chord),
                     up = glm::normalize(view - glm::dot(view, along) * along);
    double twice_area = 0, s = 0, height = 0;
    const auto go_to = [&](const glm::dvec3& to) {
      const double next_s = glm::dot(to - ends[0], along), next = glm::dot(to - ends[0], up);
      twice_area += (next_s - s) * (next + height), s = next_s, height = next;
    };
    for (glm::ivec2 at = own.first; at != own.last + step(k); at += step(k)) go_to(position(at));
    go_to(ends[1]);
    const double width = glm::dot(chord, across_view(own)),
                 round = double(kDepthOfWidth) * 4 / std::numbers::pi,
                 shown = round * std::max(twice_area, 0.0) / width;
    if (lines == 0) return {INFINITY, shown};
    edges[0] = position(farthest[1].first) - position(farthest[0].first);
    edges[1] = position(farthest[1].last) - position(farthest[0].last);
    const double cosine = std::abs(glm::dot(glm::normalize(edges[0]), glm::normalize(edges[1]))),
                 parallel = std::clamp((cosine - 0.9) / 0.06, 0.0, 1.0);
    double side = INFINITY;
    for (const int e : {0, 1}) {
      const glm::dvec3 end = ends[std::size_t(e)], out = glm::normalize(e ? chord : -chord),
                       edge = glm::normalize(edges[e]),
                       m = glm::normalize(out - glm::dot(out, edge) * edge), v = to_viewer(end);
      const double seen = glm::dot(m, v) - std::abs(glm::dot(edge, v)) / lines;
      if (seen <= 0) continue;
      const double half = 0.5 * double(step_px(k)) * pixel(position(pixels[e])) / seen,
                   behind = room(pixels[e] + (e ? 1 : -1) * step(k), end, out);
      if (half < behind) side = std::min(side, half / std::min(1.0, 2 - 2 * half / behind));
    }
    return {float(shown + side / parallel * glm::length(chord) / width), shown};
  }

  const Geometry& g_;
  const Plane<unsigned char>& connections_;
  PixelFootprint footprint_;
  std::array<Plane<PlainRun>, kDirections.size()> runs_;
};

struct Behind {
  float distance = INFINITY;
  int sender = -1;
};

/// The surface that goes on behind a pixel.
inline Behind plain_behind(const Geometry& g, const PlainGuess& guess, const glm::ivec2& p) {
  Behind found;
  float nearest_px = INFINITY;
  const glm::vec3 front = guess.at(p)->position;
  const glm::vec3 along = -direction_to_viewer(front, g.camera.orthographic);
  for (std::size_t k = 0; k < kDirections.size(); ++k) {
    const PlainRun& run = guess.run(p, k);
    for (const bool after : {false, true}) {
      const glm::ivec2 end = after ? run.last : run.first,
                       to = end + (after ? 1 : -1) * PlainGuess::step(k), way = glm::abs(to - p);
      const auto other = guess.at(to);
      if (!other || other->position.z > guess.at(end)->position.z) continue;
      const float away_px = float(std::max(way.x, way.y)) * PlainGuess::step_px(k);
      const float distance =
          glm::dot(other->normal, other->position - front) / glm::dot(other->normal, along);
      if (!(distance > 0 && distance < INFINITY) || away_px >= nearest_px) continue;
      nearest_px = away_px;
      found = {distance, int(g.surfaces.index(to.x, to.y))};
    }
  }
  return found;
}

}  // namespace ssdo::test
