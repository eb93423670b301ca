// SPDX-License-Identifier: Apache-2.0
//
// A sky dome in a G-buffer is a surface like any other, and hides all of the sky. What tells it
// from the walls of a place is its shape: the far surfaces of the frame lie on one sphere, which
// has the camera inside, is seen from its inside, and is several times as large as all else that is
// seen.
//
// The sphere |p - c| = r is fitted as |p|^2 = 2 c.p + k, which is linear, to the far surfaces, then
// again to those that lie on it. A room, a street or a terrain has far surfaces of which most lie
// on no sphere, however it is fitted. How many pixels show the dome does not matter. The answer is
// yes or no for a frame: where a shot's dome is hardly larger than the scene, it may change from
// one frame to the next.
#include "scene/objects/backdrop.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <vector>

namespace ssdo {
namespace {

/// Samples of a frame, in rows and columns.
constexpr int kSamples = 96;

/// Fewest samples that a sphere is fitted to.
constexpr std::size_t kFewest = 24;

/// What lies off a sphere by less than this share of its radius is on it: domes of 16 segments do.
constexpr double kOnSphere = 0.02;

/// Share of the surfaces farther than half of the radius that lie on the sphere.
constexpr double kMostOnSphere = 0.8;

/// Least radius over the distance of all but a tenth of what is not on it.
constexpr double kLarger = 3;

/// Least mean distance of what is on it from the camera, over the radius. Far rows of a floor are
/// arcs, which lie on spheres too, with a middle high above them.
constexpr double kAround = 0.5;

/// Least mean cosine between normals and the way to the middle.
constexpr double kInward = 0.9;

constexpr int kRounds = 6;

struct Sphere {
  glm::dvec3 middle{0};
  double radius = 0;

  bool has(const glm::dvec3& p) const {
    return std::abs(glm::distance(p, middle) - radius) <= kOnSphere * radius;
  }
};

using Samples = std::vector<const Surfel*>;

Samples samples_of(const Geometry& g) {
  const int dx = std::max(1, g.surfel.width / kSamples),
            dy = std::max(1, g.surfel.height / kSamples);
  Samples samples;
  for (int y = dy / 2; y < g.surfel.height; y += dy)
    for (int x = dx / 2; x < g.surfel.width; x += dx)
      if (g.surfel(x, y).is_surface()) samples.push_back(&g.surfel(x, y));
  return samples;
}

double distance_of(const Surfel* s) { return glm::length(glm::dvec3(s->position)); }

/// Distances in units of `unit`, so that sums keep their digits.
std::optional<Sphere> fit(const Samples& samples, double unit) {
  if (samples.size() < kFewest) return std::nullopt;
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Surfel* s : samples) {
    const glm::dvec3 p = glm::dvec3(s->position) / unit;
    const Eigen::Vector4d row(2 * p.x, 2 * p.y, 2 * p.z, 1);
    sums += row * row.transpose();
    right += row * glm::dot(p, p);
  }
  const Eigen::Vector4d found = sums.ldlt().solve(right);
  const glm::dvec3 middle(found[0], found[1], found[2]);
  const double radius2 = found[3] + glm::dot(middle, middle);
  if (!(radius2 > 0) || !std::isfinite(radius2)) return std::nullopt;
  return Sphere{unit * middle, unit * std::sqrt(radius2)};
}

/// The sphere of the far surfaces.
std::optional<Sphere> far_sphere(const Samples& samples) {
  double farthest = 0;
  for (const Surfel* s : samples) farthest = std::max(farthest, distance_of(s));
  Samples far;
  std::ranges::copy_if(samples, std::back_inserter(far),
                       [&](const Surfel* s) { return distance_of(s) > 0.5 * farthest; });
  std::optional<Sphere> sphere = fit(far, farthest);
  for (int round = 0; sphere && round < kRounds; ++round) {
    const auto off = [&](const Surfel* s) {
      return std::abs(glm::distance(glm::dvec3(s->position), sphere->middle) - sphere->radius);
    };
    std::vector<double> all;
    for (const Surfel* s : far) all.push_back(off(s));
    std::ranges::nth_element(all, all.begin() + std::ptrdiff_t(all.size() / 2));
    const double most = std::max(all[all.size() / 2], kOnSphere * sphere->radius);
    Samples near_it;
    std::ranges::copy_if(far, std::back_inserter(near_it),
                         [&](const Surfel* s) { return off(s) <= most; });
    sphere = fit(near_it, farthest);
  }
  return sphere;
}

bool is_dome(const Sphere& sphere, const Samples& samples) {
  if (glm::length(sphere.middle) >= sphere.radius) return false;
  std::vector<double> others;
  double far = 0, on = 0, inward = 0, distances = 0;
  for (const Surfel* s : samples) {
    const glm::dvec3 p(s->position);
    const bool is_on = sphere.has(p);
    if (!is_on) others.push_back(distance_of(s));
    far += distance_of(s) > 0.5 * sphere.radius;
    if (!is_on) continue;
    on += 1, distances += distance_of(s);
    inward += glm::dot(glm::dvec3(s->normal), (sphere.middle - p) / sphere.radius);
  }
  if (on < double(kFewest) || on < kMostOnSphere * far || inward < kInward * on) return false;
  if (distances < kAround * sphere.radius * on) return false;
  if (others.empty()) return true;
  const auto most = others.begin() + std::ptrdiff_t(others.size() * 9 / 10);
  std::ranges::nth_element(others, most);
  return sphere.radius >= kLarger * *most;
}

}  // namespace

std::optional<Backdrop> find_backdrop(const Geometry& g) {
  if (g.camera.orthographic) return std::nullopt;
  const Samples samples = samples_of(g);
  const std::optional<Sphere> sphere = far_sphere(samples);
  if (!sphere || !is_dome(*sphere, samples)) return std::nullopt;
  Backdrop found{Plane<float>(g.surfel.width, g.surfel.height, 0.0f), 0, sphere->radius};
  for (std::size_t i = 0; i < g.surfel.size(); ++i) {
    if (!g.surfel[i].is_surface() || !sphere->has(glm::dvec3(g.surfel[i].position))) continue;
    found.coverage[i] = 1;
    found.share += 1 / double(g.surfel.size());
  }
  return found;
}

}  // namespace ssdo
