// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/projection_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "scene/camera/eigen.h"
#include "scene/marked_pixels.h"

namespace ssdo {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMaxSamples = 20000;
constexpr int kParameters = 10;  // rotation 3, translation 3, fx, fy, cx, cy

std::vector<double> distances(const ProjectionModel& model, const Samples& samples) {
  std::vector<double> out;
  out.reserve(samples.items.size());
  for (const Sample& s : samples.items) {
    const glm::dvec2 miss = model.project(s.p) - s.pixel;
    out.push_back(std::sqrt(miss.x * miss.x + miss.y * miss.y));
  }
  return out;
}

/// J^T J and J^T r of the reprojection error in the ten parameters.
struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> jtj;
  Eigen::Matrix<double, kParameters, 1> jtr;

  NormalEquations() { jtj.setZero(), jtr.setZero(); }
  NormalEquations& operator+=(const NormalEquations& other) {
    jtj += other.jtj, jtr += other.jtr;
    return *this;
  }
};

NormalEquations linearise(const ProjectionModel& model, const Samples& samples) {
  const Matrix3d rotation = eigen(model.rotation);
  const Vector3d translation = eigen(model.translation);
  const auto add = [&](NormalEquations& eq, const Sample& s) {
    const Vector3d turned = rotation * eigen(s.p), q = turned + translation;
    const double iz = model.orthographic ? 1 : 1 / q.z(), x = q.x() * iz, y = q.y() * iz;
    const double by_z = model.orthographic ? 0 : -iz;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << model.fx * iz, 0, model.fx * x * by_z, 0, model.fy * iz, model.fy * y * by_z;
    // A small rotation w moves the turned point by w x turned = -[turned]x w.
    Matrix3d by_rotation;
    by_rotation << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(),
        0;
    Eigen::Matrix<double, 2, kParameters> j;
    j.leftCols<3>() = by_point * by_rotation;
    j.middleCols<3>(3) = by_point;
    j.rightCols<4>() << x, 0, 1, 0, 0, y, 0, 1;
    // Eigen takes a product of this size for one of large matrices.
    eq.jtj += j.transpose().lazyProduct(j);
    const glm::dvec2 miss = s.pixel - model.project(s.p);
    eq.jtr += j.transpose() * Eigen::Vector2d(miss.x, miss.y);
  };
  return sum_over(samples.items, NormalEquations(), add);
}

/// The rotation vector and the translation that lead from a prior to a model, in the axes of the
/// camera.
Eigen::Matrix<double, 6, 1> way_from(const PosePrior& prior, const ProjectionModel& model) {
  const Eigen::AngleAxisd turn(
      Matrix3d(eigen(model.rotation) * eigen(prior.pose.rotation).transpose()));
  Eigen::Matrix<double, 6, 1> way;
  way << turn.angle() * turn.axis(), eigen(model.translation) - eigen(prior.pose.translation);
  return way;
}

}  // namespace

glm::dvec2 ProjectionModel::project(const glm::dvec3& p) const {
  const glm::dvec3 q = rotation * p + translation;
  const double w = orthographic ? 1.0 : 1.0 / q.z;
  return {cx + fx * q.x * w, cy + fy * q.y * w};
}

Samples collect_samples(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                        const Window& window) {
  // An odd stride, so that samples do not line up in columns.
  const std::size_t stride = (count_marked(valid) / kMaxSamples) | 1;
  Samples samples;
  for (const std::size_t i : every_marked(valid, stride)) {
    const int x = int(i % std::size_t(valid.width)), y = int(i / std::size_t(valid.width));
    const glm::dvec2 centre(window.x0 + x + 0.5, window.y0 + y + 0.5);
    samples.items.push_back({glm::dvec3(positions[i]), centre});
  }
  if (samples.items.empty()) return samples;

  for (const Sample& s : samples.items) samples.centre += s.p;
  samples.centre /= double(samples.items.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (Sample& s : samples.items) {
    s.p -= samples.centre;
    covariance += eigen(s.p) * eigen(s.p).transpose();
  }
  covariance /= double(samples.items.size());
  samples.scale = std::sqrt(std::max(covariance.trace() / 3, 1e-300));
  for (Sample& s : samples.items) s.p /= samples.scale;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  const Vector3d spread = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt() / samples.scale;
  samples.spread = glm::make_vec3(spread.data());
  samples.axes = glm::make_mat3(solver.eigenvectors().data());
  return samples;
}

Camera camera_of(const ProjectionModel& model, const Samples& samples, const Window& window) {
  Camera camera;
  camera.orthographic = model.orthographic;
  const double per_unit = model.orthographic ? 1 / samples.scale : 1;
  camera.fx = model.fx * per_unit;
  camera.fy = model.fy * per_unit;
  camera.cx = model.cx;
  camera.cy = model.cy;
  const Matrix3d axes = eigen(model.rotation);
  Vector3d translation = eigen(model.translation) * samples.scale;
  if (model.orthographic) {
    // The axis may run anywhere: through the middle of the frame, and behind every sample.
    camera.cx = 0.5 * (window.x0 + window.x1);
    camera.cy = 0.5 * (window.y0 + window.y1);
    double nearest = 0;
    for (const Sample& s : samples.items) {
      nearest = std::min(nearest, (axes.row(2) * eigen(s.p)).value());
    }
    const glm::dvec2 centre = model.project(glm::dvec3(0));
    translation = {(centre.x - camera.cx) / camera.fx, (centre.y - camera.cy) / camera.fy,
                   samples.scale * (1 - nearest)};
  }
  const Vector3d origin = eigen(samples.centre) - axes.transpose() * translation;
  const Matrix3d rotation = Vector3d(1, -1, -1).asDiagonal() * axes;
  for (int row = 0; row < 3; ++row) {
    camera.origin[row] = origin[row];
    for (int column = 0; column < 3; ++column) camera.rotation[column][row] = rotation(row, column);
  }
  return camera;
}

ProjectionModel model_of(const Camera& camera, const Samples& samples) {
  const Matrix3d axes = Vector3d(1, -1, -1).asDiagonal() * eigen(camera.rotation);
  const Vector3d translation = axes * eigen(samples.centre - camera.origin) / samples.scale;
  const double scale = camera.orthographic ? samples.scale : 1;
  return {camera.orthographic,
          glm::make_mat3(axes.data()),
          glm::make_vec3(translation.data()),
          camera.fx * scale,
          camera.fy * scale,
          camera.cx,
          camera.cy};
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const std::size_t k = std::min(values.size() - 1, std::size_t(q * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(k), values.end());
  return values[k];
}

Samples inliers(const ProjectionModel& model, const Samples& samples) {
  const auto d = distances(model, samples);
  const double limit = 3 * 1.4826 * quantile(d, 0.5) + 1e-3;
  Samples kept = samples;
  kept.items.clear();
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= limit) kept.items.push_back(samples.items[i]);
  }
  return kept;
}

double reprojection_rms(const ProjectionModel& model, const Samples& samples) {
  const double sum = sum_over(samples.items, 0.0, [&](double& squares, const Sample& s) {
    const glm::dvec2 miss = model.project(s.p) - s.pixel;
    squares += glm::dot(miss, miss);
  });
  return std::sqrt(sum / double(std::max<std::size_t>(1, samples.items.size())));
}

double pose_cost(const ProjectionModel& model, const Samples& samples, const PosePrior& prior) {
  const double rms = reprojection_rms(model, samples);
  return rms * rms + prior.weight * way_from(prior, model).squaredNorm() /
                         double(std::max<std::size_t>(1, samples.items.size()));
}

void refine(ProjectionModel& model, const Samples& samples, bool pose_only,
            const PosePrior* prior) {
  const int n = pose_only || prior ? 6 : kParameters;
  const auto cost_of = [&](const ProjectionModel& m) {
    return prior ? pose_cost(m, samples, *prior) : reprojection_rms(m, samples);
  };
  double cost = cost_of(model);
  for (int iteration = 0; iteration < 8; ++iteration) {
    NormalEquations eq = linearise(model, samples);
    if (prior) {
      eq.jtj.diagonal().head<6>().array() += prior->weight;
      eq.jtr.head<6>() -= prior->weight * way_from(*prior, model);
    }
    const Eigen::VectorXd step = eq.jtj.topLeftCorner(n, n).ldlt().solve(eq.jtr.head(n));
    if (!step.allFinite()) return;
    ProjectionModel next = model;
    const Vector3d w = step.head<3>();
    if (w.norm() > 0) {
      const Matrix3d turned =
          Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * eigen(model.rotation);
      next.rotation = glm::make_mat3(turned.data());
    }
    next.translation += glm::dvec3(step(3), step(4), step(5));
    if (n == kParameters) {
      next.fx += step(6), next.fy += step(7), next.cx += step(8), next.cy += step(9);
    }
    const double next_cost = cost_of(next);
    if (!(next_cost < cost)) return;
    model = next, cost = next_cost;
  }
}

double focal_uncertainty(const ProjectionModel& model, const Samples& samples) {
  const NormalEquations eq = linearise(model, samples);
  const Eigen::VectorXd scale = eq.jtj.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * eq.jtj * scale.asDiagonal();
  const double inverse = scaled.inverse()(6, 6) * scale(6) * scale(6);
  // Positions are never better than about 1e-4 px, however well a few of them agree.
  const double sigma = std::max(reprojection_rms(model, samples), 1e-4);
  const double relative = sigma * std::sqrt(inverse) / model.fx;
  return std::isfinite(relative) ? relative : 1.0;
}

}  // namespace ssdo
