// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/fit_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "scene/camera/eigen.h"
#include "scene/camera/fit.h"
#include "scene/camera/null_vector.h"
#include "scene/camera/projection_model.h"

namespace ssdo {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Between frames of a shot, cameras turn by about this many radians, and move by about this share
/// of the distance of what they show: a quarter turn in two seconds of 24 frames.
constexpr double kUsualMove = 0.03;

/// P is taken to be no more precise than this. In a shot of Cycles, P of 32 bits lands 0.0044 px
/// from the middles of its pixels (median), 0.01 px (99 %). The closer together pixels lie,
/// relative to this precision, the less they tell of the pose.
constexpr double kPrecisionInShotPx = 0.005;

/// A plane seen by a known projection: the homography from the plane to directions holds two
/// columns of the rotation and the translation (Zhang 2000, section 3.1).
ProjectionModel pose_of_plane(const Samples& samples, const Camera& projection) {
  const Vector3d e1 = eigen(samples.axes[2]), e2 = eigen(samples.axes[1]);
  Eigen::MatrixXd ata = Eigen::MatrixXd::Zero(9, 9);
  for (const Sample& s : samples.items) {
    const Vector3d h(e1.dot(eigen(s.p)), e2.dot(eigen(s.p)), 1);
    const double u = (s.pixel.x - projection.cx) / projection.fx;
    const double v = (s.pixel.y - projection.cy) / projection.fy;
    Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
    rows.block<1, 3>(0, 0) = h.transpose();
    rows.block<1, 3>(0, 6) = -u * h.transpose();
    rows.block<1, 3>(1, 3) = h.transpose();
    rows.block<1, 3>(1, 6) = -v * h.transpose();
    ata += rows.transpose() * rows;
  }
  const std::vector<double> null = null_vector(ata.data(), 9);
  const Eigen::Map<const Eigen::VectorXd> m(null.data(), 9);
  Matrix3d h;
  for (int i = 0; i < 3; ++i) h.row(i) = m.segment<3>(3 * i).transpose();
  h *= (h(2, 2) < 0 ? -2 : 2) / (h.col(0).norm() + h.col(1).norm());

  Matrix3d on_plane, in_space;
  on_plane << h.col(0), h.col(1), h.col(0).cross(h.col(1));
  in_space << e1, e2, e1.cross(e2);
  const Eigen::JacobiSVD<Matrix3d> svd(on_plane, Eigen::ComputeFullU | Eigen::ComputeFullV);
  ProjectionModel model;
  const Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose() * in_space.transpose();
  model.rotation = glm::make_mat3(rotation.data());
  model.translation = {h(0, 2), h(1, 2), h(2, 2)};
  model.fx = projection.fx, model.fy = projection.fy;
  model.cx = projection.cx, model.cy = projection.cy;
  return model;
}

/// The unit of length of a pose: the distance of the samples from a camera, or the width of the
/// picture of an orthographic one.
double unit_of(const Camera& camera, const Samples& samples, const Window& window) {
  if (camera.orthographic) return window.width() / camera.fx;
  return glm::distance(camera.origin, samples.centre);
}

/// The same samples with another unit.
Samples rescaled(Samples samples, double unit) {
  for (Sample& s : samples.items) s.p *= samples.scale / unit;
  samples.scale = unit;
  return samples;
}

}  // namespace

std::optional<Camera> fit_pose(const Camera& projection, const Plane<glm::vec3>& positions,
                               const Plane<unsigned char>& valid, const Window& window,
                               double step) {
  if (const auto own = in_own_space(projection, positions, valid, window)) return own;
  const Samples samples = collect_samples(positions, valid, window);
  if (projection.orthographic || samples.items.size() < 4 ||
      samples.spread[1] < 1e-5 * samples.spread[2]) {
    return std::nullopt;
  }
  ProjectionModel model = pose_of_plane(samples, projection);
  refine(model, samples, true);
  const Camera camera = camera_of(model, samples, window);
  return explains(camera, positions, valid, window, step) ? std::optional(camera) : std::nullopt;
}

std::optional<Camera> fit_pose_near(const Camera& beside, const Plane<glm::vec3>& positions,
                                    const Plane<unsigned char>& valid, const Window& window,
                                    double step) {
  Samples samples = collect_samples(positions, valid, window);
  if (samples.items.empty()) return std::nullopt;
  const double unit = unit_of(beside, samples, window);
  if (!(unit > 0)) return std::nullopt;
  samples = rescaled(std::move(samples), unit);
  const double precision = std::max(kPrecisionInShotPx,
                                    step * beside.fx / (beside.orthographic ? 1 : unit)),
               weight = precision * precision / (kUsualMove * kUsualMove);
  const PosePrior prior{model_of(beside, samples), weight};
  // If P shows a plane and the camera has moved far, only a fit to P alone starts near enough.
  std::vector<ProjectionModel> starts = {prior.pose};
  if (const auto own = fit_pose(beside, positions, valid, window, step))
    starts.push_back(model_of(*own, samples));
  std::optional<Camera> best;
  double least = std::numeric_limits<double>::infinity();
  for (ProjectionModel& model : starts) {
    refine(model, samples, true, &prior);
    const double cost = pose_cost(model, samples, prior);
    const Camera camera = camera_of(model, samples, window);
    if (!(cost < least) || !explains(camera, positions, valid, window, step)) continue;
    best = camera, least = cost;
  }
  return best;
}

}  // namespace ssdo
