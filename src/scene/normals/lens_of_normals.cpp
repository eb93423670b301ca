// SPDX-License-Identifier: Apache-2.0
//
// A depth z(u, v) behind a lens of focal length f makes the surface z (u / f, v / f, -1), whose
// normal is along
//
//   (f dz/du, f dz/dv, u dz/du + v dz/dv + z)
//
// so that a normal n of the focal length f has the direction (k nx, k ny, nz) under k f. The ratio
// k is sought for which one rotation brings the stored normals to those of the surfaces.
#include "scene/normals/lens_of_normals.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "scene/camera/projection_model.h"
#include "scene/normals/normals.h"
#include "scene/normals/smooth_gradient.h"
#include "scene/straight.h"

namespace ssdo {
namespace {

constexpr std::size_t kMostPixels = 40000, kPrimeStride = 1000003, kFewestNormals = 64;
constexpr std::size_t kCells = 5, kMostInCell = 60;

/// Ratios of focal lengths that are tried, in steps of 5 %, then halved until 0.1 %.
constexpr double kMostRatio = 8, kStep = 0.05, kSmallestStep = 0.001;

/// Another lens is suggested where it differs by this much and misses the normals by less than half
/// of the angle, which rounding and bumps do not explain.
constexpr double kLeastChange = 0.04, kMuchNearer = 0.5, kLeastMiss = 1;

constexpr int kRounds = 3;         ///< of the rotation, without the pixels that agree worst
constexpr double kAgreeing = 0.7;  ///< share of the pixels that a rotation is found from

struct Pair {
  Eigen::Vector3d surface, stored;
};

/// The cell of a cube around the origin that the tip of a unit vector is in.
std::size_t cell_of(const Eigen::Vector3d& n) {
  std::size_t cell = 0;
  for (int c = 0; c < 3; ++c)
    cell = kCells * cell + std::min(std::size_t((n[c] + 1) / 2 * kCells), kCells - 1);
  return cell;
}

/// The step over a pixel between its neighbours, if the three are nearly on a line.
std::optional<glm::vec3> straight_step(const Surfel& p, const std::optional<Surfel>& before,
                                       const std::optional<Surfel>& after) {
  if (!before || !after) return std::nullopt;
  if (!is_straight(before->position, p.position, after->position, kStraight)) return std::nullopt;
  return after->position - before->position;
}

/// The unit normal of the surface through a pixel that faces the viewer; 0 where it is not smooth.
glm::vec3 smooth_normal(const Surfaces& surfels, int x, int y) {
  const Surfel& s = surfels(x, y);
  const auto right = straight_step(s, surface_at(surfels, x - 1, y), surface_at(surfels, x + 1, y)),
             up = straight_step(s, surface_at(surfels, x, y + 1), surface_at(surfels, x, y - 1));
  if (!right || !up) return glm::vec3(0);
  const glm::dvec3 n = glm::cross(glm::dvec3(*right), glm::dvec3(*up));
  return glm::length(n) > 0 ? glm::vec3(glm::normalize(n)) : glm::vec3(0);
}

/// Takes at most kMostInCell pairs per direction: a floor that fills the picture must not dominate,
/// since it does not constrain the lens (under any lens it is a plane).
std::vector<Pair> collect(const Plane<glm::vec3>& stored, const Geometry& geometry) {
  std::vector<Pair> pairs;
  std::array<std::size_t, kCells * kCells * kCells> counts{};
  const Surfaces& surfels = geometry.surfaces;
  for (std::size_t k = 0; k < std::min(surfels.size(), kMostPixels); ++k) {
    // A stride that is prime visits every pixel once, spread over the picture.
    const std::size_t i = k * kPrimeStride % surfels.size();
    const double length = glm::length(glm::dvec3(stored[i]));
    if (!surfels[i].is_surface() || !(length > 1e-4 && length < 1e4)) continue;
    const Eigen::Vector3d n = Eigen::Vector3d(stored[i].x, stored[i].y, stored[i].z) / length;
    if (counts[cell_of(n)] == kMostInCell) continue;
    const int x = int(i % std::size_t(surfels.width)), y = int(i / std::size_t(surfels.width));
    const glm::vec3 g = smooth_normal(surfels, x, y);
    if (g == glm::vec3(0)) continue;
    ++counts[cell_of(n)];
    pairs.push_back({Eigen::Vector3d(g.x, g.y, g.z), n});
  }
  return pairs;
}

/// The median angle in degrees that is left between the normals of surfaces under `ratio` times the
/// focal length and the stored ones, turned by the rotation or reflection that fits them (Markley
/// 1988).
double miss_under(double ratio, const std::vector<Pair>& pairs) {
  std::vector<Eigen::Vector3d> scaled;
  for (const Pair& pair : pairs) {
    const Eigen::Vector3d n(ratio * pair.surface.x(), ratio * pair.surface.y(), pair.surface.z());
    scaled.push_back(n.normalized());
  }
  std::vector<double> angles(pairs.size(), 0.0);
  for (int round = 0; round < kRounds; ++round) {
    const double most = quantile(angles, kAgreeing);
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      if (angles[i] <= most) products += scaled[i] * pairs[i].stored.transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      angles[i] = std::acos(std::clamp(scaled[i].dot(turn * pairs[i].stored), -1.0, 1.0));
  }
  return glm::degrees(quantile(angles, 0.5));
}

}  // namespace

std::optional<LensOfNormals> find_lens_of_normals(const Plane<glm::vec3>& stored,
                                                  const Geometry& geometry) {
  const std::vector<Pair> pairs = collect(stored, geometry);
  if (pairs.size() < kFewestNormals) return std::nullopt;
  LensOfNormals found;
  found.miss = found.miss_before = miss_under(1, pairs);
  if (found.miss_before < kLeastMiss) return std::nullopt;
  const auto consider = [&](double ratio) {
    const double miss = miss_under(ratio, pairs);
    if (miss < found.miss) found.focal_ratio = ratio, found.miss = miss;
  };
  for (double ratio = 1 / kMostRatio; ratio < kMostRatio; ratio *= 1 + kStep) consider(ratio);
  for (double step = kStep / 2; step > kSmallestStep; step /= 2) {
    const double middle = found.focal_ratio;
    consider(middle * (1 + step)), consider(middle / (1 + step));
  }
  const bool clearly = std::abs(std::log(found.focal_ratio)) > kLeastChange &&
                       found.miss < kMuchNearer * found.miss_before;
  return clearly ? std::optional(found) : std::nullopt;
}

}  // namespace ssdo
