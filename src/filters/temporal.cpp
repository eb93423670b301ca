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
// What moves by itself keeps its history where a motion layer tells p'. Its P was another one, by
// an unknown vector d, of which the picture shows the part m across the view: the distance between
// the p' of the layer and that of the cameras, in scene units at p. The limit of both distances to
// tangent planes grows by 2 m, the length of a d that is up to 60 degrees out of the picture's
// plane; what comes straight at the viewer begins anew. Where the layer tells what the cameras
// tell, nothing of the test changes: what a moving thing uncovers stands still itself, and is held
// to its own P. Normals are compared as they are, so that a thing may turn by 26 degrees a frame.
//
// What differs from its use in games: a mean over all frames up to the 16th, so that a camera at
// rest converges to it, and only then one that forgets; P is known, so no motion vectors are needed
// for what stands still; there is no clamp to the colours of the neighbours, which takes noise for
// light.
//
// Known faults: light that changes where the surface does not, such as the shadow of what moves,
// arrives over 16 frames; the bent normal of what turns lags behind it.
#include "filters/temporal.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kMostFrames = 15;     ///< of history: the mean counts 16 with the present one
constexpr double kLeastCosine = 0.9;  ///< normals 26 degrees apart are of two surfaces
constexpr double kLeastShare = 0.1;   ///< of the bilinear weight
constexpr double kSlant = 2;          ///< a thing's way, over what the picture shows of it

// Of motion that is held to the cameras: least pixels of theirs, and factor to be off; one pixel of
// so many in a row and in a column tells.
constexpr double kLeastMove = 0.1, kMostDifference = 0.3;
constexpr int kEvery = 4;

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
        pixel_size_(1 / before.camera.fx, 1 / before.camera.fy) {}

  /// From the camera space of the frame before to the present one.
  glm::mat3 to_present() const { return glm::mat3(glm::transpose(turn_)); }

  /// Where the camera before saw a point of the present one's space, had it not moved: pixels of
  /// the display window. Not finite where that camera looked away.
  glm::dvec2 place(const glm::vec4& position) const {
    const glm::dvec3 p = turn_ * glm::dvec3(position) + step_;
    return before_.camera.orthographic || p.z < 0 ? before_.camera.project(p) : glm::dvec2(NAN);
  }

  /// `told` is where the thing was seen according to its motion, not finite where nothing tells.
  Footprint find(const Surfel& surfel, const glm::dvec2& told) const {
    Footprint found;
    const glm::dvec3 p = turn_ * glm::dvec3(surfel.position) + step_;
    const glm::dvec2 still = place(surfel.position);
    const bool moves = std::isfinite(told.x) && std::isfinite(told.y);
    const double scale = before_.camera.orthographic ? 1.0 : -p.z,
                 way = moves ? kSlant * scale * glm::length((told - still) * pixel_size_) : 0.0,
                 limit = 0.5 * scale * pixel_size_.x + surfel.normal.w + way;
    const glm::dvec2 at =
        (moves ? told : still) - glm::dvec2(before_.window.x0 + 0.5, before_.window.y0 + 0.5);
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
      if (!shows_same(before_.surfel[i], p, normal, limit)) continue;
      found.pixel[found.count] = i;
      found.weight[found.count++] = float(weight);
      sum += weight;
    }
    if (sum < kLeastShare) found.count = 0;
    for (int k = 0; k < found.count; ++k) found.weight[k] /= float(sum);
    return found;
  }

 private:
  static bool shows_same(const Surfel& q, const glm::dvec3& p, const glm::dvec3& normal,
                         double limit) {
    if (q.position.w == 0) return false;
    const glm::dvec3 away = glm::dvec3(q.position) - p, other(q.normal);
    limit += q.normal.w;
    return glm::dot(normal, other) >= kLeastCosine && std::abs(glm::dot(normal, away)) <= limit &&
           std::abs(glm::dot(other, away)) <= limit;
  }

  const Geometry& before_;
  const glm::dmat3 turn_;
  const glm::dvec3 step_;
  const glm::dvec2 pixel_size_;  ///< at depth 1, or at any where the camera is orthographic
};

bool same_products(const Products& a, const Products& b) {
  return a.ao.empty() == b.ao.empty() && a.direct.empty() == b.direct.empty() &&
         a.bounce.empty() == b.bounce.empty() && a.bent.empty() == b.bent.empty() &&
         a.reflection.empty() == b.reflection.empty() && a.error.empty() == b.error.empty();
}

glm::dvec2 centre_of(const Geometry& geometry, int x, int y) {
  return {geometry.window.x0 + x + 0.5, geometry.window.y0 + y + 0.5};
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

History accumulate(const History* before, const Geometry& geometry, const Products& now,
                   const Plane<glm::vec2>& motion) {
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
      const glm::dvec2 told =
          motion.empty() ? glm::dvec2(NAN) : centre_of(geometry, x, y) + glm::dvec2(motion[i]);
      const Footprint at = reprojection.find(geometry.surfel[i], told);
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

bool contradicts_cameras(const Geometry& before, const Geometry& geometry,
                         const Plane<glm::vec2>& motion) {
  if (!before.world_known || !geometry.world_known) return false;
  const Reprojection reprojection(before, geometry);
  std::vector<double> factors[2];  // along each axis, of what the cameras say
  std::size_t surfaces = 0;
  for (int y = 0; y < geometry.surfel.height; y += kEvery) {
    for (int x = 0; x < geometry.surfel.width; x += kEvery) {
      const std::size_t i = geometry.surfel.index(x, y);
      if (!geometry.is_surface(i)) continue;
      surfaces += 1;
      const glm::dvec2 by_cameras =
          reprojection.place(geometry.surfel[i].position) - centre_of(geometry, x, y);
      for (int axis = 0; axis < 2; ++axis) {
        const double factor = double(motion[i][axis]) / by_cameras[axis];
        if (std::abs(by_cameras[axis]) > kLeastMove && std::isfinite(factor))
          factors[axis].push_back(factor);
      }
    }
  }
  return std::any_of(std::begin(factors), std::end(factors), [&](std::vector<double>& of_axis) {
    if (of_axis.size() <= surfaces / 4) return false;
    const auto middle = of_axis.begin() + std::ptrdiff_t(of_axis.size() / 2);
    std::nth_element(of_axis.begin(), middle, of_axis.end());
    return std::abs(*middle - 1) > kMostDifference;
  });
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
