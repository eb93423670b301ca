// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/backdrop_shapes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace ssdo {
namespace {

/// Samples of a frame, in rows and columns.
constexpr int kSamples = 96;

/// How many samples have their plane tried as that of all samples.
constexpr std::size_t kCandidates = 64;

/// Least mean distance from the camera of the samples on a cylinder, over its radius.
constexpr double kAroundCylinder = 0.5;

constexpr int kRounds = 6;

/// Fits in units of `unit`, so that sums keep their digits. The middle along an axis is not
/// determined: the one of the least length is taken.
std::optional<RoundShape> fit(const SurfelSamples& samples, const glm::dvec3& axis, double unit) {
  if (samples.size() < kFewestOfShape) return std::nullopt;
  RoundShape round{axis};
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Surfel& s : samples) {
    const glm::dvec3 p = round.across(glm::dvec3(s.position) / unit);
    const Eigen::Vector4d row(2 * p.x, 2 * p.y, 2 * p.z, 1);
    sums += row * row.transpose();
    right += row * glm::dot(p, p);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sums(i, j) += double(samples.size()) * axis[i] * axis[j];
  const Eigen::Vector4d found = sums.ldlt().solve(right);
  const glm::dvec3 middle(found[0], found[1], found[2]);
  const double radius2 = found[3] + glm::dot(middle, middle);
  if (!(radius2 > 0) || !std::isfinite(radius2)) return std::nullopt;
  round.middle = unit * middle, round.radius = unit * std::sqrt(radius2);
  return round;
}

}  // namespace

double median(std::vector<double> all) {
  std::ranges::nth_element(all, all.begin() + std::ptrdiff_t(all.size() / 2));
  return all[all.size() / 2];
}

SurfelSamples samples_of(const Geometry& g) {
  const int dx = std::max(1, g.surfaces.width / kSamples),
            dy = std::max(1, g.surfaces.height / kSamples);
  SurfelSamples samples;
  for (int y = dy / 2; y < g.surfaces.height; y += dy)
    for (int x = dx / 2; x < g.surfaces.width; x += dx)
      if (g.surfaces(x, y).is_surface()) samples.push_back(g.surfaces(x, y));
  return samples;
}

double farthest_of(const SurfelSamples& samples) {
  double farthest = 0;
  for (const Surfel& s : samples) farthest = std::max(farthest, distance_of(s));
  return farthest;
}

SurfelSamples farther_than(const SurfelSamples& samples, double distance) {
  SurfelSamples far;
  std::ranges::copy_if(samples, std::back_inserter(far),
                       [&](const Surfel& s) { return distance_of(s) > distance; });
  return far;
}

std::optional<RoundShape> round_of(const SurfelSamples& far, const glm::dvec3& axis, double unit) {
  std::optional<RoundShape> shape = fit(far, axis, unit);
  for (int round = 0; shape && round < kRounds; ++round) {
    std::vector<double> all;
    for (const Surfel& s : far) all.push_back(shape->off(glm::dvec3(s.position)));
    const double most = std::max(median(all), kOnShape * shape->radius);
    SurfelSamples near_it;
    std::ranges::copy_if(far, std::back_inserter(near_it), [&](const Surfel& s) {
      return shape->off(glm::dvec3(s.position)) <= most;
    });
    shape = fit(near_it, axis, unit);
  }
  return shape;
}

bool is_cylinder_around(const RoundShape& cylinder, const SurfelSamples& far, double share) {
  if (glm::length(cylinder.middle) >= cylinder.radius) return false;
  double on = 0, inward = 0, distances = 0;
  for (const Surfel& s : far) {
    const glm::dvec3 p(s.position);
    if (!cylinder.has(p)) continue;
    on += 1, distances += glm::length(cylinder.across(p));
    inward += glm::dot(glm::dvec3(s.normal), cylinder.to_middle(p));
  }
  return on >= share * double(far.size()) && inward >= kInward * on &&
         distances >= kAroundCylinder * cylinder.radius * on;
}

std::optional<Flat> flat_of(const SurfelSamples& all) {
  Flat best;
  std::ptrdiff_t most = 0;
  for (std::size_t k = 0; k < all.size(); k += 1 + all.size() / kCandidates) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(all[k].normal));
    const Flat flat{normal, -glm::dot(normal, glm::dvec3(all[k].position))};
    if (!(flat.distance > 0)) continue;
    const std::ptrdiff_t on =
        std::ranges::count_if(all, [&](const Surfel& s) { return flat.has(s); });
    if (on > most) most = on, best = flat;
  }
  if (most == 0) return std::nullopt;
  Flat mean;
  for (const Surfel& s : all)
    if (best.has(s)) mean.normal += glm::dvec3(s.normal);
  mean.normal = glm::normalize(mean.normal);
  for (const Surfel& s : all)
    if (best.has(s)) mean.distance -= glm::dot(mean.normal, glm::dvec3(s.position)) / double(most);
  return mean;
}

std::vector<Flat> take_flats(SurfelSamples& left, double share,
                             const std::function<bool(const Flat&)>& may_be) {
  std::vector<Flat> flats;
  const double most_left = (1 - share) * double(left.size());
  while (double(left.size()) > most_left && flats.size() < kMostPlanes) {
    const std::optional<Flat> flat = flat_of(left);
    if (!flat || !may_be(*flat)) break;
    SurfelSamples off;
    std::ranges::copy_if(left, std::back_inserter(off),
                         [&](const Surfel& s) { return !flat->has(s); });
    if (left.size() - off.size() < kFewestOfShape) break;
    left = std::move(off);
    flats.push_back(*flat);
  }
  return flats;
}

}  // namespace ssdo
