// SPDX-License-Identifier: Apache-2.0
//
// A point of one frame has moved, come or gone if the other frame looks through its place at what
// lies behind (SeenBefore::through). Points are taken on a grid, and joined to balls. The depth of
// a body is taken to be its width in the picture, along a row or a column, whichever is less: the
// centres of the balls lie half that depth behind the visible surface.
#include "filters/shot/moved.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include "filters/shot/shot_reprojection.h"
#include "math/plane.h"
#include "parallel/tiles.h"
#include "scene/camera/camera_change.h"

namespace ssdo {
namespace {

/// Points across a piece.
constexpr int kPiece = 8;

/// Least points of a piece: fewer may be an edge that one of the two cameras misses.
constexpr int kFewestPoints = 3;

/// Reach of a ball over the root mean square distance of its points from their mean.
constexpr float kBallReach = 1.5f;

/// Points of a frame on a grid, and which of them have moved.
class MovedPoints {
 public:
  MovedPoints(const KeptSurfaces& shown_in, const KeptSurfaces& seen_through_by,
              const ObjectMotion& motion)
      : shown_in_(shown_in),
        motion_(motion),
        stride_(grid_step(shown_in)),
        columns_((shown_in.window.width() + stride_ - 1) / stride_),
        rows_((shown_in.window.height() + stride_ - 1) / stride_),
        moved_(Plane<unsigned char>::like(Plane<unsigned char>(columns_, rows_))) {
    const ShotReprojection reprojection(seen_through_by, shown_in);
    for_each_row(rows_, [&](int row) {
      RowOfPoints points;
      for (int column = 0; column < columns_; column += RowOfPoints::kMost) {
        const int count = std::min(RowOfPoints::kMost, columns_ - column);
        load_points(shown_in, {column * stride_, row * stride_, stride_, count}, points);
        reprojection.find_through(points, &moved_(column, row));
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
  const glm::vec3& position(int column, int row) const {
    return shown_in_.pixels[shown_in_.index(column * stride_, row * stride_)].position;
  }

  /// Distance from one grid point to the next, at the depth of `p`.
  float spacing_at(const glm::vec3& p) const {
    return float(stride_) * (shown_in_.camera.orthographic ? 1.0f : -p.z) /
           float(shown_in_.camera.fx);
  }

  /// Number of moved points in an unbroken line through the moved point `from`.
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
    glm::vec3 sum(0), velocity(0);
    float squares = 0, area = 0, deep = 0;
    int count = 0;
    for (int row = top; row < std::min(top + kPiece, rows_); ++row) {
      for (int column = left; column < std::min(left + kPiece, columns_); ++column) {
        if (!moved_(column, row)) continue;
        const glm::vec3& p = position(column, row);
        const float spacing = spacing_at(p);
        velocity +=
            velocity_of(motion_, shown_in_, shown_in_.index(column * stride_, row * stride_));
        sum += p, squares += glm::dot(p, p);
        area += spacing * spacing;
        deep += spacing * float(std::min(run({column, row}, {1, 0}), run({column, row}, {0, 1})));
        ++count;
      }
    }
    if (count < kFewestPoints) return;
    const glm::vec3 middle = sum / float(count), away = shown_in_.camera.orthographic
                                                            ? glm::vec3(0, 0, -1)
                                                            : glm::normalize(middle);
    const float half = deep / float(2 * count),
                spread = std::max(squares / float(count) - glm::dot(middle, middle), 0.0f);
    pieces.push_back({middle + half * away, std::hypot(kBallReach * std::sqrt(spread), half), area,
                      velocity / float(count)});
  }

  const KeptSurfaces& shown_in_;
  const ObjectMotion& motion_;
  const int stride_, columns_, rows_;
  Plane<unsigned char> moved_;
};

}  // namespace

std::vector<MovedPiece> find_pieces(const KeptSurfaces& shown_in,
                                    const KeptSurfaces& seen_through_by,
                                    const ObjectMotion& motion) {
  if (!shown_in.world_known || !seen_through_by.world_known) return {};
  return MovedPoints(shown_in, seen_through_by, motion).pieces();
}

std::vector<MovedPiece> moved_pieces(const Camera& now, const Camera& other,
                                     std::vector<MovedPiece> disappeared,
                                     const std::vector<MovedPiece>& appeared) {
  const CameraChange change(other, now);
  for (MovedPiece piece : appeared) {
    piece.centre = glm::vec3(change.position(piece.centre));
    disappeared.push_back(piece);
  }
  return disappeared;
}

}  // namespace ssdo
