// SPDX-License-Identifier: Apache-2.0
//
// Measured solids know where their fronts are, but often neither their backs nor what is behind
// them. Both are guessed from the frame with what is in front of them taken away: there the same
// rules hold as in any frame, that things are about as thick as they are wide and that surfaces go
// on behind them (solids.cpp). Layer by layer, k = 1, 2, ...:
//
// - The frame without what is in front of its measured solids k shows these, and elsewhere what it
//   showed before. From it come their normals, their guessed thicknesses, and the guess of what is
//   behind the last solid that is measured in a pixel.
// - A guessed thickness ends at the next measured front. Where solids are measured behind a pixel,
//   the guess of what is behind its surface is dropped.
// - A measured solid that lies where a surface was guessed to go on in the step before is that
//   surface, and sends its light; so do its neighbours on the same surface, along rows and columns.
//   Other measured solids send nothing: their albedo is not known.
#include "scene/deep/join_measured.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "math/infinity.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/same_surface.h"

namespace ssdo {
namespace {

class Join {
 public:
  Join(const Geometry& geometry, const MeasuredSolids& measured, std::optional<float> thickness)
      : geometry_(geometry),
        measured_(measured),
        thickness_(thickness),
        footprint_(geometry.camera),
        shown_(geometry),
        owner_(geometry.surfaces.width, geometry.surfaces.height) {
    for (std::size_t i = 0; i < owner_.size(); ++i) owner_[i] = int(i);
    guess_ = guess();
  }

  Solids run() {
    const std::size_t layers = measured_.behind.size();
    Plane<float> before_seen = guess_.thickness;
    add_guesses(0);
    for (std::size_t k = 0; k < layers; ++k) {
      place(k);
      guess_ = guess();
      add_thicknesses(k);
      add_guesses(k + 1);
    }
    out_.thickness = std::move(guess_.thickness);
    out_.end = Plane<Provenance>(owner_.width, owner_.height, Provenance::guessed);
    for_each_pixel([&](std::size_t i) {
      float& thickness = out_.thickness[i];
      if (has(0, i)) thickness = std::min(before_seen[i], measured_.behind[0].distance[i]);
      if (measured_.seen_thickness[i] < kInfinity) {
        thickness = measured_.seen_thickness[i];
        out_.end[i] = Provenance::measured;
      }
    });
    return std::move(out_);
  }

 private:
  Solids guess() const {
    return thickness_ ? constant_thickness(shown_, *thickness_) : guess_solids(shown_);
  }

  template <class Work>
  void for_each_pixel(const Work& work) const {
    const int w = owner_.width;
    for_each_row(owner_.height, [&](int y) {
      for (std::size_t i = owner_.index(0, y), end = i + std::size_t(w); i < end; ++i) work(i);
    });
  }

  bool has(std::size_t layer, std::size_t pixel) const {
    return layer < measured_.behind.size() && measured_.behind[layer].distance[pixel] < kInfinity;
  }

  /// The distance from the surface that the pixel shows to the one that it shows without what is in
  /// front of layer `k`.
  float distance_to(std::size_t k, std::size_t pixel) const {
    return k == 0 ? 0 : measured_.behind[k - 1].distance[pixel];
  }

  SolidLayer& layer(std::size_t k) {
    while (out_.behind.size() <= k) {
      out_.behind.emplace_back(owner_.width, owner_.height, Provenance::measured);
      out_.behind.back().normal = Plane<glm::vec3>(owner_.width, owner_.height);
    }
    return out_.behind[k];
  }

  /// The guess of what is behind the pixels whose last measured solid is `shown_` now.
  void add_guesses(std::size_t k) {
    if (guess_.behind.empty() || k == kMostBehind) return;
    SolidLayer& to = layer(k);
    for_each_pixel([&](std::size_t i) {
      const Solid found = guess_.at(1, i);
      if ((k > 0 && !has(k - 1, i)) || has(k, i) || !found.exists()) return;
      const auto source = std::size_t(found.sender);
      to.provenance[i] = Provenance::guessed;
      to.distance[i] = distance_to(k, i) + found.distance;
      to.thickness[i] = found.thickness;
      to.sender[i] = owner_[source];
      to.normal[i] = shown_.surfaces[source].normal;
    });
  }

  /// Takes away what is in front of the measured solids of a layer, and shows these.
  void place(std::size_t k) {
    SolidLayer& to = layer(k);
    Plane<int> senders = owner_;
    for_each_pixel([&](std::size_t i) {
      if (!has(k, i)) return;
      to.distance[i] = measured_.behind[k].distance[i];
      to.sender[i] = senders[i] = sender_of(k, i);
    });
    for_each_pixel([&](std::size_t i) {
      if (has(k, i)) shown_.surfaces.set_position(i, point_behind(geometry_, i, to.distance[i]));
    });
    owner_ = std::move(senders);
    for_each_row(owner_.height, [&](int y) {
      for (int x = 0; x < owner_.width; ++x) {
        const std::size_t i = owner_.index(x, y);
        if (has(k, i)) to.normal[i] = normal_at(x, y);
      }
    });
    for_each_pixel([&](std::size_t i) {
      if (has(k, i)) shown_.surfaces.set_normal(i, to.normal[i]);
    });
    spread_senders(k);
  }

  /// Gives measured solids without a sender that of the nearest neighbour on the same surface which
  /// has one, along rows and columns.
  void spread_senders(std::size_t k) {
    Plane<int> found = owner_,
               distance(owner_.width, owner_.height, std::numeric_limits<int>::max());
    const auto sweep = [&](std::ptrdiff_t first, std::ptrdiff_t step, int count) {
      int sender = -1, away = 0;
      for (std::ptrdiff_t n = 0, at = first; n < count; ++n, at += step) {
        const auto i = std::size_t(at);
        if (n == 0 || !joined(i, std::size_t(at - step))) sender = -1;
        ++away;
        if (owner_[i] >= 0) {
          sender = owner_[i], away = 0;
        } else if (sender >= 0 && has(k, i) && away < distance[i]) {
          found[i] = sender, distance[i] = away;
        }
      }
    };
    const std::ptrdiff_t w = owner_.width, h = owner_.height;
    for_each_row(int(h), [&](int y) {
      sweep(y * w, 1, int(w));
      sweep(y * w + w - 1, -1, int(w));
    });
    for_each_row(int(w), [&](int x) {
      sweep(x, w, int(h));
      sweep((h - 1) * w + x, -w, int(h));
    });
    owner_ = std::move(found);
    for_each_pixel([&](std::size_t i) {
      if (has(k, i)) layer(k).sender[i] = owner_[i];
    });
  }

  bool joined(std::size_t i, std::size_t j) const {
    const Surfel &a = shown_.surfaces[i], &b = shown_.surfaces[j];
    return a.is_surface() && b.is_surface() &&
           on_one_surface({a.position, a.normal}, {b.position, b.normal}, footprint_);
  }

  /// The pixel that shows the surface that goes on behind what is shown, if a measured solid lies
  /// on it.
  int sender_of(std::size_t k, std::size_t i) const {
    if (guess_.behind.empty()) return -1;
    const Solid found = guess_.at(1, i);
    if (!found.exists()) return -1;
    const glm::vec3 front = point_behind(geometry_, i, measured_.behind[k].distance[i]),
                    normal = shown_.surfaces[std::size_t(found.sender)].normal;
    const float apart = measured_.behind[k].distance[i] - distance_to(k, i) - found.distance,
                facing = std::max(glm::dot(normal, to_viewer(front)), kLeastCosine);
    const bool joined = std::abs(apart) * facing <= kSurfaceGap * footprint_.at(-front.z);
    return joined ? owner_[std::size_t(found.sender)] : -1;
  }

  glm::vec3 normal_at(int x, int y) const {
    const glm::vec3 view = to_viewer(shown_.surfaces(x, y).position),
                    normal = gradient_normal(shown_.surfaces, x, y, view);
    return normal == glm::vec3(0) ? view : normal;
  }

  glm::vec3 to_viewer(const glm::vec3& p) const {
    return direction_to_viewer(p, geometry_.camera.orthographic);
  }

  void add_thicknesses(std::size_t k) {
    SolidLayer& to = layer(k);
    for_each_pixel([&](std::size_t i) {
      if (!has(k, i)) return;
      const float room = has(k + 1, i) ? measured_.behind[k + 1].distance[i] - to.distance[i]
                                       : kInfinity,
                  measured = measured_.behind[k].thickness[i];
      to.thickness[i] = measured < kInfinity ? measured : std::min(guess_.thickness[i], room);
    });
  }

  const Geometry& geometry_;
  const MeasuredSolids& measured_;
  std::optional<float> thickness_;
  PixelFootprint footprint_;
  Geometry shown_;    ///< the frame without what is in front of the solids placed so far
  Plane<int> owner_;  ///< the pixel that shows each of its surfaces in the frame itself; -1: none
  Solids guess_;      ///< of `shown_`
  Solids out_;
};

}  // namespace

Solids join_measured(const Geometry& geometry, const MeasuredSolids& measured,
                     std::optional<float> thickness) {
  return Join(geometry, measured, thickness).run();
}

}  // namespace ssdo
