// SPDX-License-Identifier: Apache-2.0
#include "scene/light/distant_source.h"

#include <algorithm>

namespace ssdo {
namespace {

constexpr int kHalvings = 7;  ///< 128 parts of a source at the horizon
constexpr int kSide = 64;     ///< 64 x 64 even points are divided among them

using Points = std::vector<glm::vec3>;

/// Halves the points across the axis along which they spread most, again and again, and adds the
/// means of the last parts to `means`.
void divide(Points::iterator begin, Points::iterator end, int halvings, Points& means) {
  const float count = float(end - begin);
  glm::vec3 mean(0);
  for (auto p = begin; p != end; ++p) mean += *p / count;
  if (halvings == 0) {
    means.push_back(mean);
    return;
  }
  glm::vec3 spread(0);
  for (auto p = begin; p != end; ++p) spread += (*p - mean) * (*p - mean);
  int axis = spread.y > spread.x ? 1 : 0;
  if (spread.z > spread[axis]) axis = 2;
  const auto middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end,
                   [=](const glm::vec3& a, const glm::vec3& b) { return a[axis] < b[axis]; });
  divide(begin, middle, halvings - 1, means);
  divide(middle, end, halvings - 1, means);
}

}  // namespace

void set_points(DistantSource& sun) {
  Points places;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column)
      places.push_back(sun.point((glm::vec2(float(column), float(row)) + 0.5f) / float(kSide)));
  }
  sun.points.clear();
  divide(places.begin(), places.end(), kHalvings, sun.points);
  glm::vec3 mean(0);
  for (const glm::vec3& point : sun.points) mean += point / float(sun.points.size());
  // A sum over so many places is a little off the sum over all texels.
  const float scale = 1 / glm::length(mean);
  for (glm::vec3& point : sun.points) point = scale * point + (sun.direction - scale * mean);
  sun.point_radius = std::sqrt(sun.extent.x * sun.extent.y / float(sun.points.size())) / 2;
}

float DistantSource::cosine_at_horizon(const glm::vec3& normal) const {
  float sum = 0;
  for (const glm::vec3& point : points)
    sum += mean_above_horizon(glm::dot(normal, point), point_radius);
  return sum / float(points.size());
}

void DistantSource::turn(const glm::mat3& by) {
  direction = by * direction;
  shape.turn(by);
  for (glm::vec3& point : points) point = by * point;
}

}  // namespace ssdo
