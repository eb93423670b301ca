// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/projection_model.h"

#include <algorithm>
#include <cmath>

namespace ssdo {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kMaxSamples = 20000;
constexpr int kParameters = 10;  // rotation 3, translation 3, fx, fy, cx, cy

std::vector<double> distances(const ProjectionModel& model, const Samples& samples) {
  std::vector<double> out;
  out.reserve(samples.items.size());
  for (const Sample& s : samples.items) out.push_back((model.project(s.p) - s.pixel).norm());
  return out;
}

/// J^T J and J^T r of the reprojection error in the ten parameters.
struct NormalEquations {
  Eigen::Matrix<double, kParameters, kParameters> jtj;
  Eigen::Matrix<double, kParameters, 1> jtr;
};

NormalEquations linearise(const ProjectionModel& model, const Samples& samples) {
  NormalEquations eq;
  eq.jtj.setZero();
  eq.jtr.setZero();
  for (const Sample& s : samples.items) {
    const Vector3d turned = model.rotation * s.p, q = turned + model.translation;
    const double iz = 1 / q.z(), x = q.x() * iz, y = q.y() * iz;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << model.fx * iz, 0, -model.fx * x * iz, 0, model.fy * iz, -model.fy * y * iz;
    // A small rotation w moves the turned point by w x turned = -[turned]x w.
    Matrix3d by_rotation;
    by_rotation << 0, turned.z(), -turned.y(), -turned.z(), 0, turned.x(), turned.y(), -turned.x(),
        0;
    Eigen::Matrix<double, 2, kParameters> j;
    j.leftCols<3>() = by_point * by_rotation;
    j.middleCols<3>(3) = by_point;
    j.rightCols<4>() << x, 0, 1, 0, 0, y, 0, 1;
    eq.jtj += j.transpose() * j;
    eq.jtr += j.transpose() * (s.pixel - model.project(s.p));
  }
  return eq;
}

}  // namespace

Samples collect_samples(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                        const Window& window) {
  std::size_t count = 0;
  for (unsigned char v : valid.pixels) count += v != 0;
  // An odd stride, so that samples do not line up in columns.
  const std::size_t stride = (count / kMaxSamples) | 1;

  Samples samples;
  std::size_t seen = 0;
  for (int y = 0; y < positions.height; ++y) {
    for (int x = 0; x < positions.width; ++x) {
      if (!valid(x, y) || seen++ % stride != 0) continue;
      const glm::vec3 p = positions(x, y);
      samples.items.push_back({{p.x, p.y, p.z}, {window.x0 + x + 0.5, window.y0 + y + 0.5}});
    }
  }
  if (samples.items.empty()) return samples;

  for (const Sample& s : samples.items) samples.centre += s.p;
  samples.centre /= double(samples.items.size());
  Matrix3d covariance = Matrix3d::Zero();
  for (Sample& s : samples.items) {
    s.p -= samples.centre;
    covariance += s.p * s.p.transpose();
  }
  covariance /= double(samples.items.size());
  samples.scale = std::sqrt(std::max(covariance.trace() / 3, 1e-300));
  for (Sample& s : samples.items) s.p /= samples.scale;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(covariance);
  samples.spread = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt() / samples.scale;
  samples.axes = solver.eigenvectors();
  return samples;
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
  double sum = 0;
  for (double d : distances(model, samples)) sum += d * d;
  return std::sqrt(sum / double(std::max<std::size_t>(1, samples.items.size())));
}

void refine(ProjectionModel& model, const Samples& samples, bool pose_only) {
  const int n = pose_only ? 6 : kParameters;
  for (int iteration = 0; iteration < 8; ++iteration) {
    const NormalEquations eq = linearise(model, samples);
    const Eigen::VectorXd step = eq.jtj.topLeftCorner(n, n).ldlt().solve(eq.jtr.head(n));
    if (!step.allFinite()) return;
    ProjectionModel next = model;
    const Vector3d w = step.head<3>();
    if (w.norm() > 0) {
      next.rotation =
          Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix() * model.rotation;
    }
    next.translation += step.segment<3>(3);
    if (!pose_only) {
      next.fx += step(6), next.fy += step(7), next.cx += step(8), next.cy += step(9);
    }
    if (!(reprojection_rms(next, samples) < reprojection_rms(model, samples))) return;
    model = next;
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
