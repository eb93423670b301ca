// SPDX-License-Identifier: Apache-2.0
//
// A position p of the pixel whose direction is d, in the camera's axes, satisfies
//
//   d x (A p + b) = 0,   A = s R, b = -s R c,   R the rotation, c the camera's place
//
// which is linear in the twelve numbers A and b: the direct linear transform of cameras (Hartley
// and Zisserman, Multiple View Geometry, 7.1), for directions in place of points of a picture.
#include "scene/camera/panorama.h"

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "scene/camera/fit.h"
#include "scene/camera/null_vector.h"
#include "scene/camera/projection_model.h"

namespace ssdo {
namespace {

constexpr int kUnknowns = 12;

/// Adds v v^T.
void add_square(std::vector<double>& matrix, const std::array<double, kUnknowns>& v) {
  for (int i = 0; i < kUnknowns; ++i)
    for (int j = 0; j < kUnknowns; ++j)
      matrix[std::size_t(i * kUnknowns + j)] += v[std::size_t(i)] * v[std::size_t(j)];
}

/// The orthogonal matrix nearest to one that is nearly so up to its size: Newton's iteration for
/// the polar decomposition (Higham 1986).
glm::dmat3 nearest_rotation(glm::dmat3 a) {
  for (int i = 0; i < 60; ++i) a = 0.5 * (a + glm::transpose(glm::inverse(a)));
  return a;
}

}  // namespace

std::optional<Camera> fit_panorama(const Plane<glm::vec3>& positions,
                                   const Plane<unsigned char>& valid, const Window& window,
                                   const Window& display) {
  Camera camera;
  camera.panorama = true;
  camera.fx = display.width() / (2 * glm::pi<double>());
  camera.fy = display.height() / glm::pi<double>();
  camera.cx = 0.5 * (display.x0 + display.x1);
  camera.cy = 0.5 * (display.y0 + display.y1);
  const Samples samples = collect_samples(positions, valid, window);
  if (samples.items.size() < 6) return std::nullopt;

  std::vector<double> squares(kUnknowns * kUnknowns, 0.0);
  std::vector<glm::dvec3> directions;
  for (const Sample& s : samples.items) {
    const glm::dvec3 d = camera.ray(s.pixel).direction;
    directions.push_back(d);
    // Unknown 4 i + j is row i of A and, with j = 3, of b. Row k of the cross product is
    // d_i times row j of A p + b less d_j times row i, for (i, j, k) in cyclic order.
    for (int k = 0; k < 3; ++k) {
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      std::array<double, kUnknowns> row{};
      for (int c = 0; c < 4; ++c) {
        const double value = c < 3 ? s.p[c] : 1.0;
        row[std::size_t(4 * j + c)] = d[i] * value;
        row[std::size_t(4 * i + c)] = -d[j] * value;
      }
      add_square(squares, row);
    }
  }
  const std::vector<double> x = null_vector(squares.data(), kUnknowns);
  glm::dmat3 a;
  glm::dvec3 b;
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) a[c][row] = x[std::size_t(4 * row + c)];
    b[row] = x[std::size_t(4 * row + 3)];
  }
  double before = 0;
  for (std::size_t k = 0; k < directions.size(); ++k)
    before += glm::dot(directions[k], a * samples.items[k].p + b);
  if (before < 0) a = -a, b = -b;
  if (!(std::abs(glm::determinant(a)) > 1e-12)) return std::nullopt;

  camera.rotation = nearest_rotation(a);
  camera.origin = samples.centre - samples.scale * (glm::inverse(a) * b);
  const Residual residual = measure_residual(camera, positions, valid, window);
  return residual.median_px < 0.5 ? std::optional(camera) : std::nullopt;
}

}  // namespace ssdo
