// SPDX-License-Identifier: Apache-2.0
//
// Reprojection of what earlier frames have found (Nehab et al., "Accelerating Real-Time Shading
// with Reverse Reprojection Caching", 2007), the temporal filter of ground-truth ambient occlusion.
//
//   mean(p) = (n h + now(p)) / (n + 1),  n = min(frames(p'), 15)
//
// h is what the frame before has at p', where its camera saw the point that p shows: the bilinear
// average of the pixels around p' that show the same surface,
//
//   |N_p . (q - p)| and |N_q . (q - p)| <= half the width of a pixel at p + the rounding of P,
//   N_p . N_q >= 0.9,
//
// their weights scaled to a sum of 1. Where they have less than a tenth of the weight, p was
// hidden, outside the picture, or has moved: it begins anew with n = 0. The two distances to
// tangent planes do not grow with that between q and p, so that a surface which hides p from the
// camera before is told from it even at grazing angles.
//
// What differs from its use in games: a mean over all frames up to the 16th, so that a camera at
// rest converges to it, and only then one that forgets; P is known, so no motion vectors are needed
// for what stands still; what moves has no history, as its P is another one; there is no clamp to
// the colours of the neighbours, which takes noise for light.
#include "filters/temporal.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kMostFrames = 15;     ///< of history: the mean counts 16 with the present one
constexpr double kLeastCosine = 0.9;  ///< normals 26 degrees apart are of two surfaces
constexpr double kLeastShare = 0.1;   ///< of the bilinear weight

/// Pixels of the frame before with weights whose sum is 1, or none.
struct Footprint {
  std::size_t pixel[4];
  float weight[4];
  int count = 0;
};

/// Finds in the frame before what a pixel shows. Between the two camera spaces lies a rotation and
/// the camera's own step, which stay exact however far away the world's origin is.
class Reprojection {
 public:
  Reprojection(const Geometry& before, const Geometry& now)
      : before_(before),
        turn_(before.camera.rotation * glm::transpose(now.camera.rotation)),
        step_(before.camera.rotation * (now.camera.origin - before.camera.origin)),
        pixel_width_(1 / before.camera.fx) {}

  /// From the camera space of the frame before to the present one.
  glm::mat3 to_present() const { return glm::mat3(glm::transpose(turn_)); }

  Footprint find(const Surfel& surfel) const {
    Footprint found;
    const glm::dvec3 p = turn_ * glm::dvec3(surfel.position) + step_;
    if (!before_.camera.orthographic && !(p.z < 0)) return found;
    const glm::dvec2 at =
        before_.camera.project(p) - glm::dvec2(before_.window.x0 + 0.5, before_.window.y0 + 0.5);
    const double left = std::floor(at.x), top = std::floor(at.y);
    const int width = before_.surfel.width, height = before_.surfel.height;
    if (!(left >= -1 && left < width && top >= -1 && top < height)) return found;
    const glm::dvec3 normal = turn_ * glm::dvec3(surfel.normal);
    double sum = 0;
    for (int corner = 0; corner < 4; ++corner) {
      const int dx = corner % 2, dy = corner / 2, x = int(left) + dx, y = int(top) + dy;
      const double across = at.x - left, down = at.y - top,
                   weight = (dx ? across : 1 - across) * (dy ? down : 1 - down);
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const std::size_t i = before_.surfel.index(x, y);
      if (!shows_same(before_.surfel[i], p, normal, surfel.normal.w)) continue;
      found.pixel[found.count] = i;
      found.weight[found.count++] = float(weight);
      sum += weight;
    }
    if (sum < kLeastShare) found.count = 0;
    for (int k = 0; k < found.count; ++k) found.weight[k] /= float(sum);
    return found;
  }

 private:
  bool shows_same(const Surfel& q, const glm::dvec3& p, const glm::dvec3& normal,
                  float rounding) const {
    if (q.position.w == 0) return false;
    const glm::dvec3 away = glm::dvec3(q.position) - p, other(q.normal);
    const double width = pixel_width_ * (before_.camera.orthographic ? 1.0 : -p.z),
                 limit = 0.5 * width + rounding + q.normal.w;
    return glm::dot(normal, other) >= kLeastCosine && std::abs(glm::dot(normal, away)) <= limit &&
           std::abs(glm::dot(other, away)) <= limit;
  }

  const Geometry& before_;
  const glm::dmat3 turn_;
  const glm::dvec3 step_;
  const double pixel_width_;  ///< at depth 1, or at any where the camera is orthographic
};

bool same_products(const Products& a, const Products& b) {
  return a.ao.empty() == b.ao.empty() && a.direct.empty() == b.direct.empty() &&
         a.bounce.empty() == b.bounce.empty() && a.bent.empty() == b.bent.empty() &&
         a.reflection.empty() == b.reflection.empty() && a.error.empty() == b.error.empty();
}

template <class T>
T average(const Plane<T>& plane, const Footprint& at) {
  const T first = plane[at.pixel[0]];
  T step(0);  // differences, so that what is constant stays as it is
  for (int k = 1; k < at.count; ++k) step += at.weight[k] * (plane[at.pixel[k]] - first);
  return first + step;
}

/// value = (n h + value) / (n + 1), as a step for the same reason.
template <class T>
void mix(Plane<T>& values, std::size_t i, const T& history, float frames) {
  values[i] += (frames / (frames + 1)) * (history - values[i]);
}

}  // namespace

History accumulate(const History* before, const Geometry& geometry, const Products& now) {
  History after{{}, now, Plane<float>(geometry.surfel.width, geometry.surfel.height)};
  for (std::size_t i = 0; i < after.frames.size(); ++i) after.frames[i] = geometry.is_surface(i);
  if (!before || !before->geometry.world_known || !geometry.world_known ||
      !same_products(before->mean, now)) {
    return after;
  }
  const Reprojection reprojection(before->geometry, geometry);
  const glm::mat3 turn = reprojection.to_present();
  for_each_row(geometry.surfel.height, [&](int y) {
    for (int x = 0; x < geometry.surfel.width; ++x) {
      const std::size_t i = geometry.surfel.index(x, y);
      if (!geometry.is_surface(i)) continue;
      const Footprint at = reprojection.find(geometry.surfel[i]);
      if (at.count == 0) continue;
      const float frames = std::min(average(before->frames, at), kMostFrames);
      Products& mean = after.mean;
      const Products& old = before->mean;
      if (!mean.ao.empty()) mix(mean.ao, i, average(old.ao, at), frames);
      if (!mean.direct.empty()) mix(mean.direct, i, average(old.direct, at), frames);
      if (!mean.bounce.empty()) mix(mean.bounce, i, average(old.bounce, at), frames);
      if (!mean.bent.empty()) mix(mean.bent, i, turn * average(old.bent, at), frames);
      if (!mean.reflection.empty()) mix(mean.reflection, i, average(old.reflection, at), frames);
      if (!mean.error.empty()) mix(mean.error, i, average(old.error, at), frames);
      after.frames[i] = frames + 1;
    }
  });
  return after;
}

Products products_of(const History& history) {
  Products products = history.mean;
  for (Plane<float>* shares : {&products.ao, &products.reflection})
    for (float& share : shares->pixels)
      share = std::clamp(share, 0.0f, 1.0f);  // rounding leaves it
  for (glm::vec3& bent : products.bent.pixels) {
    const float length = glm::length(bent);
    bent = length > 0 ? bent / length : glm::vec3(0);
  }
  return products;
}

}  // namespace ssdo
