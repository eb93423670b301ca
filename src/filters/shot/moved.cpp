// SPDX-License-Identifier: Apache-2.0
//
// A point of one frame has moved, come or gone if the other frame looks through its place at what
// lies behind (SeenBefore::through). Points are taken on a grid, and joined to balls. A body is
// taken to be as deep as it is wide, in its picture, along a row or a column, whichever is less:
// the middles of the balls lie half as far behind what is seen.
//
// Around a receiver p with the normal n, a ball of the area A at the distance d hides at most about
//
//   F = A / (pi (d^2 + r^2)) (n . to + r) / (d + r)
//
// of what arrives by the cosine. Where the sum over balls is F, another frame is wrong at p by no
// more than that, and counts by (1 - F / kMostHidden)^2, 0 from kMostHidden on: the mean with 16
// such frames is wrong by less than half of kMostHidden.
//
// The shadow of a ball from a source is a cylinder that widens by the angle of the source. The
// weight falls to 0 between twice its radius and once.
//
// Weights are found for squares of kSquare x kSquare pixels, by the surface in the middle. A pixel
// takes the least of those around it and of what lies between their middles.
#include "filters/shot/moved.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <numbers>

#include "filters/reprojection.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kMostHidden = 0.1f;
constexpr int kSquare = 4;

/// Points across a frame, about, and across a piece.
constexpr int kPoints = 480, kPiece = 8;

/// A piece of fewer points may be an edge that one of both cameras misses.
constexpr int kFewestPoints = 3;

/// A ball reaches so much farther than the root mean square of its points.
constexpr float kReach = 1.5f;

/// Points of a frame on a grid, and which of them have moved.
class MovedPoints {
 public:
  MovedPoints(const Geometry& stands, const Geometry& looks)
      : stands_(stands),
        stride_(std::max(1, stands.surfel.width / kPoints)),
        columns_((stands.surfel.width + stride_ - 1) / stride_),
        rows_((stands.surfel.height + stride_ - 1) / stride_),
        moved_(columns_, rows_, 0) {
    const Reprojection reprojection(looks, stands);
    for_each_row(rows_, [&](int row) {
      for (int column = 0; column < columns_; ++column) {
        const Surfel& s = surfel(column, row);
        moved_(column, row) =
            s.is_surface() && reprojection.find(s, glm::dvec2(NAN)).sight == SeenBefore::through;
      }
    });
  }

  std::vector<MovedPiece> pieces() const {
    std::vector<MovedPiece> pieces;
    for (int top = 0; top < rows_; top += kPiece)
      for (int left = 0; left < columns_; left += kPiece) add_piece(left, top, pieces);
    return pieces;
  }

 private:
  const Surfel& surfel(int column, int row) const {
    return stands_.surfel(column * stride_, row * stride_);
  }

  /// From one point to the next, at the depth of one.
  float spacing_at(const Surfel& s) const {
    return float(stride_) * (stands_.camera.orthographic ? 1.0f : -s.position.z) /
           float(stands_.camera.fx);
  }

  /// Moved points in a line through one that has.
  int run(glm::ivec2 from, glm::ivec2 step) const {
    int length = 1;
    for (const int sign : {-1, 1}) {
      for (glm::ivec2 at = from + sign * step;
           at.x >= 0 && at.y >= 0 && at.x < columns_ && at.y < rows_ && moved_(at.x, at.y);
           at += sign * step)
        ++length;
    }
    return length;
  }

  void add_piece(int left, int top, std::vector<MovedPiece>& pieces) const {
    glm::vec3 sum(0);
    float squares = 0, area = 0, deep = 0;
    int count = 0;
    for (int row = top; row < std::min(top + kPiece, rows_); ++row) {
      for (int column = left; column < std::min(left + kPiece, columns_); ++column) {
        if (!moved_(column, row)) continue;
        const Surfel& s = surfel(column, row);
        const float spacing = spacing_at(s);
        sum += s.position, squares += glm::dot(s.position, s.position);
        area += spacing * spacing;
        deep += spacing * float(std::min(run({column, row}, {1, 0}), run({column, row}, {0, 1})));
        ++count;
      }
    }
    if (count < kFewestPoints) return;
    const glm::vec3 middle = sum / float(count), away = stands_.camera.orthographic
                                                            ? glm::vec3(0, 0, -1)
                                                            : glm::normalize(middle);
    const float half = deep / float(2 * count),
                spread = std::max(squares / float(count) - glm::dot(middle, middle), 0.0f);
    pieces.push_back({middle + half * away, std::hypot(kReach * std::sqrt(spread), half), area});
  }

  const Geometry& stands_;
  const int stride_, columns_, rows_;
  Plane<unsigned char> moved_;
};

/// About the largest share of the hemisphere, by the cosine, that a piece hides.
float form_factor(const MovedPiece& piece, const Surfel& at) {
  const glm::vec3 to = piece.centre - at.position;
  const float distance2 = glm::dot(to, to), distance = std::sqrt(distance2), r = piece.radius;
  const float cosine = std::clamp((glm::dot(at.normal, to) + r) / (distance + r), 0.0f, 1.0f);
  return piece.area * cosine / (std::numbers::pi_v<float> * (distance2 + r * r));
}

/// How much of a source counts at a receiver that sees it in `cone`, beside one piece.
float lit_beside(const MovedPiece& piece, const Surfel& at, const SourceCone& cone) {
  const glm::vec3 to = piece.centre - at.position;
  const float along = glm::dot(to, cone.to);
  if (along < -piece.radius || along > cone.distance + piece.radius) return 1;
  const float across = glm::length(to - along * cone.to),
              reach = piece.radius + std::max(along, 0.0f) * std::tan(cone.angular_radius);
  return std::clamp(across / reach - 1, 0.0f, 1.0f);
}

/// The least of the squares around each.
Plane<float> least_around(const Plane<float>& plane) {
  auto out = Plane<float>::like(plane);
  for (int y = 0; y < plane.height; ++y) {
    for (int x = 0; x < plane.width; ++x) {
      float least = 1;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, plane.height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, plane.width - 1); ++u)
          least = std::min(least, plane(u, v));
      out(x, y) = least;
    }
  }
  return out;
}

}  // namespace

std::vector<MovedPiece> find_moved(const Geometry& now, const Geometry& other) {
  std::vector<MovedPiece> pieces = MovedPoints(now, other).pieces();
  const glm::dmat3 turn = now.camera.rotation * glm::transpose(other.camera.rotation);
  const glm::dvec3 step = now.camera.rotation * (other.camera.origin - now.camera.origin);
  for (MovedPiece piece : MovedPoints(other, now).pieces()) {
    piece.centre = glm::vec3(turn * glm::dvec3(piece.centre) + step);
    pieces.push_back(piece);
  }
  return pieces;
}

MovedWeights::MovedWeights(const Geometry& now, const std::vector<MovedPiece>& pieces,
                           const Light& light)
    : of_all_((now.surfel.width + kSquare - 1) / kSquare,
              (now.surfel.height + kSquare - 1) / kSquare, 1.0f),
      of_sources_(light.sources.size(), of_all_) {
  const Plane<Surfel>& surfel = now.surfel;
  for_each_row(of_all_.height, [&](int row) {
    for (int column = 0; column < of_all_.width; ++column) {
      const Surfel& at = surfel(std::min(column * kSquare + kSquare / 2, surfel.width - 1),
                                std::min(row * kSquare + kSquare / 2, surfel.height - 1));
      if (!at.is_surface()) continue;
      float hidden = 0;
      for (const MovedPiece& piece : pieces) hidden += form_factor(piece, at);
      const float left = std::max(1 - hidden / kMostHidden, 0.0f);
      of_all_(column, row) = left * left;
      for (std::size_t k = 0; k < light.sources.size(); ++k) {
        const SourceCone cone = light.sources[k]->cone(at.position);
        float& lit = of_sources_[k](column, row);
        for (const MovedPiece& piece : pieces) lit = std::min(lit, lit_beside(piece, at, cone));
      }
    }
  });
  of_all_ = least_around(of_all_);
  for (Plane<float>& plane : of_sources_) plane = least_around(plane);
}

float MovedWeights::at(int source, int x, int y) const {
  const Plane<float>& plane = source < 0 ? of_all_ : of_sources_[std::size_t(source)];
  const auto place = [](int pixel, int count) {
    return std::clamp((float(pixel) + 0.5f) / kSquare - 0.5f, 0.0f, float(count - 1));
  };
  const float u = place(x, plane.width), v = place(y, plane.height);
  const int left = std::min(int(u), std::max(plane.width - 2, 0)),
            top = std::min(int(v), std::max(plane.height - 2, 0)),
            right = std::min(left + 1, plane.width - 1),
            bottom = std::min(top + 1, plane.height - 1);
  const float a = u - float(left), b = v - float(top);
  return (1 - b) * ((1 - a) * plane(left, top) + a * plane(right, top)) +
         b * ((1 - a) * plane(left, bottom) + a * plane(right, bottom));
}

}  // namespace ssdo
