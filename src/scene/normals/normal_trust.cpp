// SPDX-License-Identifier: Apache-2.0
//
// The edges of N tell whether N belongs to P. Where a normal jumps between two smooth patches
// and N follows P on both sides, P has a crease or a silhouette there: the edge is confirmed. Where
// N follows P on one side, contradicts it on the other, and P runs smoothly across, the surface is
// torn. Measured on the frames of data/ and of five scenes of Cycles, with and without a pixel
// filter: no torn edge beside 171 to 6540 confirmed ones; with N shifted by 4 to 40 pixels, or
// mirrored, 0.53 to 1 of the edges are torn. Leaves whose normals point up, or away from the centre
// of a crown, tear nothing, however much of the picture they cover; bumps of 70 degrees that alias
// towards the horizon tear up to one pixel in 2500.
#include "scene/normals/normal_trust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "parallel/tiles.h"
#include "scene/normals/normal_space.h"
#include "scene/normals/normals.h"
#include "scene/normals/smooth_gradient.h"
#include "scene/straight.h"

namespace ssdo {
namespace {

/// A linear ramp: 0 up to `from`, 1 beyond `to`; `from` may be the larger of the two.
struct Ramp {
  double from, to;
  double at(double x) const { return std::clamp((x - from) / (to - from), 0.0, 1.0); }
};

/// Share of smooth pixels with N within 53 degrees of the gradient of P. Frames of Cycles have 0.99
/// and more, and are not looked at further.
constexpr Ramp kIsInDoubt{0.97, 0.95};
/// Share of the edges that are torn. kForgivenEdges, and one in kPixelsPerForgivenEdge smooth
/// pixels, are left out.
constexpr Ramp kIsOfAnotherFrame{0.1, 0.3};
constexpr double kForgivenEdges = 4, kPixelsPerForgivenEdge = 1000;
/// Share of the smooth pixels that lie in cells where N follows P; below it, N is used in those
/// cells alone.
constexpr Ramp kFollowsP{0.35, 0.6};
/// Share of smooth pixels in which N is close to the gradient and differs from the prevailing N. A
/// constant N agrees with a floor, and with nothing else.
constexpr Ramp kTurnsWithP{0, 0.01};

/// Two measures of a cell. kIsNear: the tangent of the angle between the mean normal and the mean
/// gradient of P. kIsCoherent: the component of the mean normal along that gradient, which is 0 for
/// noise and 0.3 to 0.7 for bumps of 70 degrees.
constexpr Ramp kIsNear{0.6, 0.3};
constexpr Ramp kIsCoherent{0.1, 0.25};
constexpr int kCellsAcross = 24, kSmallestCell = 8;
constexpr float kFewestPixels = 8;

/// Cosines: N is quiet along a patch, and jumps at an edge; it follows P, or contradicts it.
constexpr float kQuiet = 0.985f, kJump = 0.866f, kFollows = 0.94f, kContradicts = 0.6f;

class Comparison {
 public:
  Comparison(const Plane<glm::vec3>& stored, const Surfaces& surfels, const NormalSpace& space,
             bool orthographic)
      : stored_(stored), surfels_(surfels), space_(space), orthographic_(orthographic) {}

  /// The unit normal as stored, in camera space; nothing on background or where none is stored.
  std::optional<glm::vec3> normal(int x, int y) const {
    if (!surface_at(surfels_, x, y)) return std::nullopt;
    const glm::vec3 n = space_.to_camera * stored_(x, y);
    const float length = glm::length(n);
    if (!(length > 1e-4f && length < 1e4f)) return std::nullopt;
    return n / length;
  }

  std::optional<glm::vec3> gradient(int x, int y) const {
    const glm::vec3 view = direction_to_viewer(surfels_(x, y).position, orthographic_);
    return smooth_gradient(surfels_, x, y, view);
  }

  enum class Edge { none, confirmed, torn };

  /// The edge of N, if any, between the pixels on both sides of (x, y); (dx, dy) is a step along a
  /// row or a column.
  Edge edge(int x, int y, int dx, int dy) const {
    constexpr std::array<int, 4> kPlaces = {-2, -1, 1, 2};
    std::array<glm::vec3, 4> n;
    for (std::size_t i = 0; i < n.size(); ++i) {
      const auto found = normal(x + kPlaces[i] * dx, y + kPlaces[i] * dy);
      if (!found) return Edge::none;
      n[i] = *found;
    }
    const auto& [before, n1, n2, after] = n;
    if (std::abs(glm::dot(n1, n2)) > kJump || glm::dot(before, n1) < kQuiet ||
        glm::dot(n2, after) < kQuiet)
      return Edge::none;
    const auto p = gradient(x - 2 * dx, y - 2 * dy), q = gradient(x + 2 * dx, y + 2 * dy);
    if (!p || !q) return Edge::none;
    const auto [least, most] =
        std::minmax({std::abs(glm::dot(*p, before)), std::abs(glm::dot(*q, after))});
    const bool bends = glm::dot(*p, *q) < kFollows;
    if (bends && least > kFollows) return Edge::confirmed;
    const bool torn = !bends && least < kContradicts && most > kFollows && is_smooth(x, y, dx, dy);
    return torn ? Edge::torn : Edge::none;
  }

 private:
  bool is_smooth(int x, int y, int dx, int dy) const {
    const auto here = surface_at(surfels_, x, y);
    if (!here) return false;
    for (int k = 1; k <= 2; ++k) {
      const glm::vec3 a = surfels_(x - k * dx, y - k * dy).position,
                      b = surfels_(x + k * dx, y + k * dy).position;
      if (!is_straight(a, here->position, b, kStraight)) return false;
    }
    return true;
  }

  const Plane<glm::vec3>& stored_;
  const Surfaces& surfels_;
  const NormalSpace& space_;
  bool orthographic_;
};

/// How sure it is that N is of another frame, 0 to 1; P is smooth in `smooth_pixels` pixels.
double foreignness(const Comparison& comparison, const Surfaces& surfels, double smooth_pixels) {
  struct Count {
    std::size_t confirmed = 0, torn = 0;
  };
  std::vector<Count> rows(std::size_t(surfels.height));
  for_each_row(surfels.height, [&](int y) {
    Count& row = rows[std::size_t(y)];
    for (int x = 0; x < surfels.width; ++x) {
      for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
        const Comparison::Edge edge = comparison.edge(x, y, dx, dy);
        row.confirmed += edge == Comparison::Edge::confirmed;
        row.torn += edge == Comparison::Edge::torn;
      }
    }
  });
  double confirmed = 0, torn = 0;
  for (const Count& row : rows) confirmed += double(row.confirmed), torn += double(row.torn);
  const double forgiven = kForgivenEdges + smooth_pixels / kPixelsPerForgivenEdge;
  return kIsOfAnotherFrame.at((torn - forgiven) / std::max(torn + confirmed, 1.0));
}

/// Sums over the smooth pixels of a cell.
struct Sums {
  glm::vec3 normals{0}, gradients{0};
  float pixels = 0;

  void operator+=(const Sums& other) {
    normals += other.normals, gradients += other.gradients, pixels += other.pixels;
  }

  /// How well N follows P on average, from 0 to 1; 0 where too few pixels tell.
  double agreement() const {
    const float length = glm::length(gradients);
    if (pixels < kFewestPixels || !(length > 0)) return 0;
    const glm::vec3 mean = normals / pixels, axis = gradients / length;
    // Without the sign: renderers that leave normals of back faces do so for a whole object.
    const float along = std::abs(glm::dot(mean, axis)),
                across = glm::length(glm::cross(mean, axis));
    return kIsCoherent.at(along) * kIsNear.at(across / std::max(along, 1e-6f));
  }
};

Sums sums_of(const Comparison& comparison, const Window& cell) {
  Sums sums;
  for (int y = cell.y0; y < cell.y1; ++y) {
    for (int x = cell.x0; x < cell.x1; ++x) {
      const auto n = comparison.normal(x, y);
      const auto gradient = n ? comparison.gradient(x, y) : std::nullopt;
      if (gradient) sums += {*n, *gradient, 1};
    }
  }
  return sums;
}

/// The agreement in every cell: the larger of its own and that of the 3 x 3 cells around it, as
/// bumps may be wider than a cell.
Plane<double> agreements_of(const Plane<Sums>& cells) {
  Plane<double> agreements(cells.width, cells.height);
  for (int j = 0; j < cells.height; ++j) {
    for (int i = 0; i < cells.width; ++i) {
      Sums around;
      for (int l = std::max(j - 1, 0); l <= std::min(j + 1, cells.height - 1); ++l)
        for (int k = std::max(i - 1, 0); k <= std::min(i + 1, cells.width - 1); ++k)
          around += cells(k, l);
      agreements(i, j) = std::max(cells(i, j).agreement(), around.agreement());
    }
  }
  return agreements;
}

}  // namespace

float NormalTrust::least() const {
  float least = 1;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (smooth[i] > 0) least = std::min(least, cells[i]);
  return least;
}

float NormalTrust::most() const {
  float most = cells.empty() ? 1.0f : 0.0f;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (smooth[i] > 0) most = std::max(most, cells[i]);
  return most;
}

float NormalTrust::mean() const {
  float sum = 0, pixels = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) sum += smooth[i] * cells[i], pixels += smooth[i];
  return pixels > 0 ? sum / pixels : 1.0f;
}

float NormalTrust::at(int x, int y) const {
  if (cells.empty()) return 1;
  const auto place = [&](int pixel, int count) {
    return std::clamp((float(pixel) + 0.5f) / float(cell_size) - 0.5f, 0.0f, float(count - 1));
  };
  const float u = place(x, cells.width), v = place(y, cells.height);
  const int i = int(u), j = int(v), k = std::min(i + 1, cells.width - 1),
            l = std::min(j + 1, cells.height - 1);
  const float s = u - float(i), t = v - float(j);
  return (1 - t) * ((1 - s) * cells(i, j) + s * cells(k, j)) +
         t * ((1 - s) * cells(i, l) + s * cells(k, l));
}

NormalTrust find_normal_trust(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                              const NormalSpace& space, bool orthographic) {
  const double doubt = kIsInDoubt.at(space.share);
  if (doubt == 0) return {};
  const Comparison comparison(stored, surfels, space, orthographic);
  const int size = std::max(kSmallestCell, surfels.width / kCellsAcross),
            columns = (surfels.width + size - 1) / size, rows = (surfels.height + size - 1) / size;
  Plane<Sums> sums(columns, rows);
  for_each_row(rows, [&](int j) {
    for (int i = 0; i < columns; ++i) {
      sums(i, j) = sums_of(comparison, {i * size, j * size, std::min((i + 1) * size, surfels.width),
                                        std::min((j + 1) * size, surfels.height)});
    }
  });
  const Plane<double> agreements = agreements_of(sums);
  double agreeing = 0, pixels = 0;
  for (std::size_t i = 0; i < sums.size(); ++i)
    agreeing += agreements[i] * double(sums[i].pixels), pixels += double(sums[i].pixels);
  const double belongs = 1 - foreignness(comparison, surfels, pixels);
  const double elsewhere =
      kFollowsP.at(agreeing / std::max(pixels, 1.0)) * kTurnsWithP.at(space.turning_share);
  NormalTrust trust;
  if (belongs == 1 && elsewhere == 1) return trust;
  trust.cells = trust.smooth = Plane<float>(columns, rows);
  for (std::size_t i = 0; i < trust.cells.size(); ++i) {
    const double used = belongs * std::max(elsewhere, agreements[i]);
    trust.cells[i] = float(1 - doubt * (1 - used));
    trust.smooth[i] = sums[i].pixels;
  }
  trust.cell_size = size;
  return trust;
}

}  // namespace ssdo
