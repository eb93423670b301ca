// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <glm/vec3.hpp>
#include <vector>

#include "math/plane.h"

namespace ssdo {

/// A position and the pixel that shows it.
struct Sample {
  Eigen::Vector3d p;      ///< recentred and scaled
  Eigen::Vector2d pixel;  ///< centre, in display-window pixels
};

/// What a camera is fitted to, and how to undo the normalisation: P = centre + scale * p.
struct Samples {
  std::vector<Sample> items;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double scale = 1;
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();    ///< standard deviations along the axes
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< principal axes in columns, ascending
};

/// At most 20,000 of the valid pixels, spread over the frame.
Samples collect_samples(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                        const Window& window);

/// A camera while it is being fitted, in the axes of computer vision (x right, y down, z forward)
/// and in the normalised space of the samples.
struct ProjectionModel {
  bool orthographic = false;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double fx = 1, fy = 1, cx = 0, cy = 0;

  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    const Eigen::Vector3d q = rotation * p + translation;
    const double w = orthographic ? 1.0 : 1.0 / q.z();
    return {cx + fx * q.x() * w, cy + fy * q.y() * w};
  }
};

/// Root mean square of the reprojection error, in pixels.
double reprojection_rms(const ProjectionModel& model, const Samples& samples);

/// The samples that agree with the model to within three robust standard deviations.
Samples inliers(const ProjectionModel& model, const Samples& samples);

/// Gauss-Newton on the reprojection error of a perspective model: on all ten parameters (rotation,
/// translation, fx, fy, cx, cy), or on the pose alone.
void refine(ProjectionModel& model, const Samples& samples, bool pose_only);

/// Relative standard error of the focal length, from the residuals that are left.
double focal_uncertainty(const ProjectionModel& model, const Samples& samples);

/// The value below which a share `q` of the values lie; 0 for none.
double quantile(std::vector<double> values, double q);

}  // namespace ssdo
