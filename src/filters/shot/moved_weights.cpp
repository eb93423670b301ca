// SPDX-License-Identifier: Apache-2.0
//
// Around a receiver p with the normal n, a ball of the area A at the distance d hides at most about
//
//   F = A / (pi (d^2 + r^2)) (n . to + r) / (d + r)
//
// of what arrives by the cosine. Where the sum over balls is F, another frame is wrong at p by no
// more than F, and has the weight (1 - F / kMostHidden)^2, 0 from kMostHidden on: the mean with 16
// such frames is wrong by less than half of kMostHidden.
//
// The shadow of a ball from a source is a cylinder that widens by the angle of the source. The
// weight falls to 0 between twice its radius and once.
//
// A receiver that moves is followed (filters/shot/point_tracker.cpp). What moves along with it hides the
// same of its hemisphere at both times. A ball that has moved by w beside p, the difference of both
// velocities times the number of frames between, counts by F min(w / 2r, 1), F the larger one of
// its places at both times.
//
// Weights are found for squares of kSquare x kSquare pixels, by the surface in the middle. Each
// square takes the least weight of itself and the squares around it; pixels are interpolated
// between the middles of squares.
//
// Compiled once for every instruction set, without fused steps, so that all round alike.
#include "filters/shot/moved_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/shot/moved_weights.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/lanes-inl.h"

#ifndef SSDO_FILTERS_SHOT_MOVED_WEIGHTS_
#define SSDO_FILTERS_SHOT_MOVED_WEIGHTS_
namespace ssdo {

/// The cones in which receivers see a source.
struct ConesOfPoints {
  alignas(64) float to[3][RowOfPoints::kMost];
  alignas(64) float distance[RowOfPoints::kMost], tangent[RowOfPoints::kMost];
};

/// Camera space, scene units in a frame; 0 for points that stand still.
struct VelocitiesOfPoints {
  alignas(64) float of[3][RowOfPoints::kMost];
};

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr int kApart = RowOfPoints::kMost;
constexpr float kMostHidden = 0.1f;

HWY_INLINE V dot_of(const V3& a, const V3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// About the largest share of the hemisphere, by the cosine, that a piece hides.
HWY_INLINE V form_factor(const MovedPiece& piece, const V3& position, const V3& normal) {
  const V3 to = set(piece.centre) - position;
  const V distance2 = dot_of(to, to), r = set(piece.radius);
  const V cosine = saturate((dot_of(normal, to) + r) / (hn::Sqrt(distance2) + r));
  return set(piece.area) * cosine / (set(std::numbers::pi_v<float>) * (distance2 + r * r));
}

/// How much of light from everywhere counts at each of the points; 1 where there is no surface.
void weigh_all(const RowOfPoints& points, const MovedPiece* pieces, std::size_t count,
               float* weights) {
  for (int i = 0; i < points.count; i += kLanes) {
    const V3 position = load_apart(&points.position[0][i], kApart),
             normal = load_apart(&points.normal[0][i], kApart);
    V hidden = set(0);
    for (std::size_t k = 0; k < count; ++k)
      hidden = hidden + form_factor(pieces[k], position, normal);
    const V left = hn::Max(set(1) - hidden / set(kMostHidden), set(0));
    store(hn::IfThenElse(position.z == position.z, left * left, set(1)), &weights[i]);
  }
}

/// The same for points that move, by their velocities; the other frame is `frames` later. 1 where
/// nothing moves.
void weigh_moving(const RowOfPoints& points, const VelocitiesOfPoints& velocities, float frames,
                  const std::vector<MovedPiece>& pieces, float* weights) {
  for (int i = 0; i < points.count; i += kLanes) {
    const V3 position = load_apart(&points.position[0][i], kApart),
             normal = load_apart(&points.normal[0][i], kApart),
             own = load_apart(&velocities.of[0][i], kApart);
    const M moves = hn::And(dot_of(own, own) > set(0), position.z == position.z);
    store(set(1), &weights[i]);
    if (!any(moves)) continue;
    V hidden = set(0);
    for (const MovedPiece& piece : pieces) {
      const V3 way = (set(piece.velocity) - own) * set(frames);
      const V changes = saturate(hn::Sqrt(dot_of(way, way)) / set(2 * piece.radius));
      const V there =
          hn::Max(form_factor(piece, position, normal), form_factor(piece, position - way, normal));
      hidden = hidden + there * changes;
    }
    const V left = hn::Max(set(1) - hidden / set(kMostHidden), set(0));
    store(hn::IfThenElse(moves, left * left, set(1)), &weights[i]);
  }
}

/// How much of a source counts at receivers that see it in these cones, beside one piece.
HWY_INLINE V lit_beside(const MovedPiece& piece, const V3& position, const V3& cone_to, V distance,
                        V tangent) {
  const V3 to = set(piece.centre) - position;
  const V along = dot_of(to, cone_to), r = set(piece.radius);
  const V3 off = {to.x - along * cone_to.x, to.y - along * cone_to.y, to.z - along * cone_to.z};
  const V reach = r + hn::Max(along, set(0)) * tangent;
  const V lit = saturate(hn::Sqrt(dot_of(off, off)) / reach - set(1));
  const M between = hn::And(along >= hn::Neg(r), along <= distance + r);
  return hn::IfThenElse(between, lit, set(1));
}

void weigh_source(const RowOfPoints& points, const ConesOfPoints& cones, const MovedPiece* pieces,
                  std::size_t count, float* weights) {
  for (int i = 0; i < points.count; i += kLanes) {
    const V3 position = load_apart(&points.position[0][i], kApart),
             to = load_apart(&cones.to[0][i], kApart);
    const V distance = load(&cones.distance[i]), tangent = load(&cones.tangent[i]);
    V lit = set(1);
    for (std::size_t k = 0; k < count; ++k)
      lit = hn::Min(lit, lit_beside(pieces[k], position, to, distance, tangent));
    store(hn::IfThenElse(position.z == position.z, lit, set(1)), &weights[i]);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(weigh_all);
HWY_EXPORT(weigh_moving);
HWY_EXPORT(weigh_source);

namespace {

/// For each square, the least of itself and the eight around it.
Plane<float> least_around(const Plane<float>& plane) {
  Plane<float> across = Plane<float>::like(plane), out = Plane<float>::like(plane);
  for_each_row(plane.height, [&](int y) {
    for (int x = 0; x < plane.width; ++x) {
      const float beside =
          std::min(plane(std::max(x - 1, 0), y), plane(std::min(x + 1, plane.width - 1), y));
      across(x, y) = std::min(plane(x, y), beside);
    }
  });
  for_each_row(plane.height, [&](int y) {
    const int above = std::max(y - 1, 0), below = std::min(y + 1, plane.height - 1);
    for (int x = 0; x < plane.width; ++x)
      out(x, y) = std::min({across(x, above), across(x, y), across(x, below)});
  });
  return out;
}

/// Finds the cones of the receivers that exist; the others get a default cone.
void find_cones(const Source& source, const RowOfPoints& points, ConesOfPoints& cones) {
  for (int i = 0; i < points.count; ++i) {
    const glm::vec3 at(points.position[0][i], points.position[1][i], points.position[2][i]);
    const SourceCone cone = std::isnan(at.z) ? SourceCone() : source.cone(at);
    cones.to[0][i] = cone.to.x, cones.to[1][i] = cone.to.y, cones.to[2][i] = cone.to.z;
    cones.distance[i] = cone.distance, cones.tangent[i] = std::tan(cone.angular_radius);
  }
}

/// Calls visit(column, row, the points in the middles of squares from there on) for all squares.
template <class Visit>
void for_each_middles(const KeptSurfaces& now, const Plane<float>& squares, const Visit& visit) {
  constexpr int kSquare = MovedWeights::kSquare;
  const int width = now.window.width(), height = now.window.height();
  for_each_row(squares.height, [&](int row) {
    RowOfPoints points;
    const int y = std::min(row * kSquare + kSquare / 2, height - 1);
    for (int column = 0; column < squares.width; column += points.count) {
      // The middle of the last square may lie outside.
      const int x = column * kSquare + kSquare / 2, inside = (width - 1 - x) / kSquare + 1;
      const RowOfPixels middles =
          x < width ? RowOfPixels{x, y, kSquare, std::min(RowOfPoints::kMost, inside)}
                    : RowOfPixels{width - 1, y, kSquare, 1};
      load_points(now, middles, points);
      visit(column, row, middles, points);
    }
  });
}

/// Velocities of what moves by more than may be noise.
void find_velocities(const KeptSurfaces& now, const ObjectMotion& motion, const RowOfPixels& row,
                     VelocitiesOfPoints& velocities) {
  for (int i = 0; i < RowOfPoints::kMost; ++i) {
    glm::vec3 velocity(0);
    const std::size_t pixel = now.index(row.x + i * row.step, row.y);
    if (i < row.count && glm::length(motion.at(pixel)) > double(ObjectMotion::kLeast))
      velocity = velocity_of(motion, now, pixel);
    for (int c = 0; c < 3; ++c) velocities.of[c][i] = velocity[c];
  }
}

}  // namespace

MovedWeights::MovedWeights(const KeptSurfaces& now, const std::vector<MovedPiece>& pieces,
                           const Light& light)
    : of_all_((now.window.width() + kSquare - 1) / kSquare,
              (now.window.height() + kSquare - 1) / kSquare, 1.0f),
      of_sources_(light.sources.size(), of_all_) {
  for_each_middles(now, of_all_, [&](int column, int row, const RowOfPixels&, RowOfPoints& points) {
    ConesOfPoints cones;
    alignas(64) float weights[RowOfPoints::kMost];
    HWY_DYNAMIC_DISPATCH(weigh_all)(points, pieces.data(), pieces.size(), weights);
    std::copy_n(weights, points.count, &of_all_(column, row));
    for (std::size_t k = 0; k < light.sources.size(); ++k) {
      find_cones(*light.sources[k], points, cones);
      HWY_DYNAMIC_DISPATCH(weigh_source)(points, cones, pieces.data(), pieces.size(), weights);
      std::copy_n(weights, points.count, &of_sources_[k](column, row));
    }
  });
  of_all_ = least_around(of_all_);
  for (Plane<float>& plane : of_sources_) plane = least_around(plane);
}

void MovedWeights::weigh_moving(const KeptSurfaces& now, const std::vector<MovedPiece>& pieces,
                                const ObjectMotion& motion, int frames) {
  of_moving_ = Plane<float>(of_all_.width, of_all_.height, 1.0f);
  if (motion.pixels.empty()) return;
  for_each_middles(now, of_moving_,
                   [&](int column, int row, const RowOfPixels& middles, RowOfPoints& points) {
                     VelocitiesOfPoints velocities;
                     alignas(64) float weights[RowOfPoints::kMost];
                     find_velocities(now, motion, middles, velocities);
                     HWY_DYNAMIC_DISPATCH(weigh_moving)
                     (points, velocities, float(frames), pieces, weights);
                     std::copy_n(weights, points.count, &of_moving_(column, row));
                   });
  of_moving_ = least_around(of_moving_);
}

void MovedWeights::row(int source, const RowOfPixels& row, float* weights) const {
  row_of(source < 0 ? of_all_ : of_sources_[std::size_t(source)], row, weights);
}

void MovedWeights::row_of_moving(const RowOfPixels& row, float* weights) const {
  row_of(of_moving_, row, weights);
}

void MovedWeights::row_of(const Plane<float>& plane, const RowOfPixels& row, float* weights) {
  const auto place = [](int pixel, int count) {
    return std::clamp((float(pixel) + 0.5f) / kSquare - 0.5f, 0.0f, float(count - 1));
  };
  const float v = place(row.y, plane.height);
  const int top = std::min(int(v), std::max(plane.height - 2, 0)),
            bottom = std::min(top + 1, plane.height - 1);
  const float down = v - float(top);
  const float *above = &plane(0, top), *below = &plane(0, bottom);
  for (int i = 0; i < row.count; ++i) {
    const float u = place(row.x + i * row.step, plane.width);
    const int left = std::min(int(u), std::max(plane.width - 2, 0)),
              right = std::min(left + 1, plane.width - 1);
    const float across = u - float(left);
    weights[i] = (1 - down) * ((1 - across) * above[left] + across * above[right]) +
                 down * ((1 - across) * below[left] + across * below[right]);
  }
}

}  // namespace ssdo
#endif
