// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "math/plane.h"
#include "parallel/tiles.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// A position and the pixel that shows it.
struct Sample {
  glm::dvec3 p;      ///< recentred and scaled
  glm::dvec2 pixel;  ///< centre, in display-window pixels
};

/// What a camera is fitted to, and how to undo the normalisation: P = centre + scale * p.
struct Samples {
  std::vector<Sample> items;
  glm::dvec3 centre{0};
  double scale = 1;
  glm::dvec3 spread{0};  ///< standard deviations along the axes
  glm::dmat3 axes{1};    ///< principal axes in columns, ascending
};

/// All valid pixels, or 13,000 to 40,000 of them, spread over the frame.
Samples collect_samples(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                        const Window& window);

/// A camera while it is being fitted, in the axes of computer vision (x right, y down, z forward)
/// and in the normalised space of the samples.
struct ProjectionModel {
  bool orthographic = false;
  glm::dmat3 rotation{1};
  glm::dvec3 translation{0};
  double fx = 1, fy = 1, cx = 0, cy = 0;

  /// The pixel that shows a point of the normalised space.
  glm::dvec2 project(const glm::dvec3& p) const;
};

/// Converts a model of normalised samples to a Camera in the space of P. The axis of an
/// orthographic camera may be placed anywhere: it goes through the middle of `window`, and begins
/// before all samples.
Camera camera_of(const ProjectionModel& model, const Samples& samples, const Window& window);

/// A camera as a model of normalised samples; no panorama.
ProjectionModel model_of(const Camera& camera, const Samples& samples);

/// The sum over samples, from `zero` on; `add(sum, sample)` adds one sample. Parts of equal length
/// are summed first, then added in order: the result is the same for any number of threads.
template <class Sum, class Add>
Sum sum_over(const std::vector<Sample>& samples, const Sum& zero, const Add& add) {
  constexpr std::size_t kPart = 1024;
  std::vector<Sum> sums((samples.size() + kPart - 1) / kPart, zero);
  for_each_task(sums.size(), [&](std::size_t part) {
    const std::size_t end = std::min(samples.size(), (part + 1) * kPart);
    for (std::size_t i = part * kPart; i < end; ++i) add(sums[part], samples[i]);
  });
  Sum all = zero;
  for (const Sum& sum : sums) all += sum;
  return all;
}

/// Root mean square of the reprojection error, in pixels.
double reprojection_rms(const ProjectionModel& model, const Samples& samples);

/// The samples that agree with the model to within three robust standard deviations.
Samples inliers(const ProjectionModel& model, const Samples& samples);

/// A pose that a fit stays near to where the samples leave it open.
struct PosePrior {
  ProjectionModel pose;
  double weight;  ///< in square pixels: of a radian of rotation and of a unit of translation
};

/// The sum of the square of reprojection_rms() and of what the prior adds per sample.
double pose_cost(const ProjectionModel& model, const Samples& samples, const PosePrior& prior);

/// Gauss-Newton on the reprojection error: of a perspective model on all ten parameters (rotation,
/// translation, fx, fy, cx, cy), or on the pose alone; with a prior, of any model on its pose.
void refine(ProjectionModel& model, const Samples& samples, bool pose_only,
            const PosePrior* prior = nullptr);

/// Relative standard error of the focal length, from the residuals that are left.
double focal_uncertainty(const ProjectionModel& model, const Samples& samples);

/// The value below which a share `q` of the values lie; 0 for none.
double quantile(std::vector<double> values, double q);

}  // namespace ssdo
