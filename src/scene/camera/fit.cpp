// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <vector>

#include "parallel/tiles.h"
#include "scene/camera/eigen.h"
#include "scene/camera/null_vector.h"
#include "scene/camera/projection_model.h"
#include "scene/order_statistics.h"

namespace ssdo {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Positions are never better than about this, however well a few of them agree.
constexpr double kPrecisionPx = 1e-4;

/// An orthographic camera is accepted only if its axes are known to about a degree.
constexpr double kMostUncertainAxes = 0.02;

/// If samples miss their pixels by more than this, no camera fits them; the nearest one is returned
/// for messages.
constexpr double kNoCameraPx = 0.5;

Eigen::VectorXd null_vector_of(const Eigen::MatrixXd& normal_matrix) {
  const std::vector<double> x = ssdo::null_vector(normal_matrix.data(), int(normal_matrix.rows()));
  return Eigen::Map<const Eigen::VectorXd>(x.data(), Eigen::Index(x.size()));
}

/// Pixels as the direct linear transform takes them: from -1 to 1.
struct PictureScale {
  Vector2d middle;
  double half;

  explicit PictureScale(const Window& window)
      : middle(0.5 * (window.x0 + window.x1), 0.5 * (window.y0 + window.y1)),
        half(0.5 * std::hypot(window.width(), window.height())) {}

  Vector2d of(const glm::dvec2& pixel) const {
    return (Vector2d(pixel.x, pixel.y) - middle) / half;
  }
};

/// Direct linear transform: M (3 x 4) with pixel ~ M (p, 1) and the points in front.
Eigen::Matrix<double, 3, 4> projective_matrix(const Samples& samples, const PictureScale& picture) {
  const auto add = [&](Eigen::MatrixXd& ata, const Sample& s) {
    const Eigen::Vector4d h(s.p.x, s.p.y, s.p.z, 1);
    const Vector2d uv = picture.of(s.pixel);
    Eigen::Matrix<double, 2, 12> rows = Eigen::Matrix<double, 2, 12>::Zero();
    rows.block<1, 4>(0, 0) = h.transpose();
    rows.block<1, 4>(0, 8) = -uv.x() * h.transpose();
    rows.block<1, 4>(1, 4) = h.transpose();
    rows.block<1, 4>(1, 8) = -uv.y() * h.transpose();
    ata += rows.transpose() * rows;
  };
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(12, 12);
  const Eigen::VectorXd m = null_vector_of(sum_over(samples.items, zero, add));
  Eigen::Matrix<double, 3, 4> matrix;
  for (int i = 0; i < 3; ++i) matrix.row(i) = m.segment<4>(4 * i).transpose();
  // w of the centroid is the last entry: the points are in front where it is positive.
  if (matrix(2, 3) < 0) matrix = -matrix;
  return matrix;
}

/// The projective matrix split by an RQ decomposition into K [R | t] with a positive diagonal of K.
ProjectionModel direct_linear_transform(const Samples& samples, const Window& window) {
  const PictureScale picture(window);
  const Vector2d& middle = picture.middle;
  const double half = picture.half;
  const Eigen::Matrix<double, 3, 4> matrix = projective_matrix(samples, picture);

  // RQ by the QR of the matrix turned upside down.
  const Matrix3d flip = Vector3d::Ones().asDiagonal().toDenseMatrix().rowwise().reverse();
  const Matrix3d turned = (flip * matrix.leftCols<3>()).transpose();
  // Matrices of dynamic size, since those of a fixed size take ten seconds to compile.
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(turned);
  const Matrix3d upper = qr.matrixQR().triangularView<Eigen::Upper>();
  const Matrix3d q = Eigen::MatrixXd(qr.householderQ());
  Matrix3d k = flip * upper.transpose() * flip, r = flip * q.transpose();
  const Matrix3d sign = k.diagonal().cwiseSign().asDiagonal();
  k = k * sign;
  r = sign * r;

  ProjectionModel model;
  const Vector3d translation = k.triangularView<Eigen::Upper>().solve(matrix.col(3));
  model.rotation = glm::make_mat3(r.data());
  model.translation = glm::make_vec3(translation.data());
  k /= k(2, 2);
  model.fx = half * k(0, 0);
  model.fy = half * k(1, 1);
  model.cx = middle.x() + half * k(0, 2);
  model.cy = middle.y() + half * k(1, 2);
  return model;
}

/// Whether the samples lie in one plane, to within the rounding of P: far from the origin, rounding
/// alone gives a plane some thickness.
bool is_flat(const ProjectionModel& model, const Samples& samples) {
  const double distance = eigen(model.translation).norm();
  return samples.spread[0] < 3 * reprojection_rms(model, samples) * distance / model.fx;
}

/// The affine camera: least squares for pixel = B p + b, its rows made orthogonal.
ProjectionModel fit_affine(const Samples& samples) {
  Eigen::Matrix4d ata = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, 4, 2> atb = Eigen::Matrix<double, 4, 2>::Zero();
  for (const Sample& s : samples.items) {
    const Eigen::Vector4d h(s.p.x, s.p.y, s.p.z, 1);
    ata += h * h.transpose();
    atb += h * Vector2d(s.pixel.x, s.pixel.y).transpose();
  }
  const Eigen::Matrix<double, 4, 2> solution = ata.ldlt().solve(atb);
  const Vector3d across = solution.col(0).head<3>(), down = solution.col(1).head<3>();
  ProjectionModel model;
  model.orthographic = true;
  model.fx = across.norm();
  model.fy = down.norm();
  const Vector3d bisector = (across.normalized() + down.normalized()).normalized();
  const Vector3d other = (across.normalized() - down.normalized()).normalized();
  Matrix3d rotation;
  rotation.row(0) = (bisector + other).normalized();
  rotation.row(1) = (bisector - other).normalized();
  // Without perspective, mirroring along the axis leaves the picture unchanged: take the
  // right-handed solution.
  rotation.row(2) = rotation.row(0).cross(rotation.row(1));
  model.rotation = glm::make_mat3(rotation.data());
  model.cx = solution(3, 0);
  model.cy = solution(3, 1);
  return model;
}

/// Relative standard error of the axes of an affine camera, from the residuals and from the
/// perspective that the samples do not rule out. A lens at distance d divides a pixel's place B p
/// by 1 + z/d, which moves it by B p z/d. The part of this motion that an affine camera can follow
/// turns its axes, as on a few pixels of a ball; the rest determines d. No lens is taken to be
/// stronger than one whose focal length is the diagonal of the picture.
double axes_uncertainty(const ProjectionModel& affine, const Samples& samples,
                        const Window& window) {
  const auto count = double(samples.items.size());
  const double freedom = 2 * count / (2 * count - 8),  // less the eight numbers of the camera
      sigma = std::max(reprojection_rms(affine, samples) * std::sqrt(freedom), kPrecisionPx);
  const double scale = std::min(affine.fx, affine.fy);
  const double by_residuals = sigma / (std::sqrt(count) * samples.spread[0] * scale);

  Eigen::MatrixXd places(samples.items.size(), 4), moves(samples.items.size(), 2);
  for (std::size_t i = 0; i < samples.items.size(); ++i) {
    const Vector3d p = eigen(samples.items[i].p), turned = eigen(affine.rotation) * p;
    const auto row = Eigen::Index(i);
    places.row(row) << p.transpose(), 1;
    moves.row(row) << affine.fx * turned.x() * turned.z(), affine.fy * turned.y() * turned.z();
  }
  const Eigen::MatrixXd followed =
      (places.transpose() * places).ldlt().solve(places.transpose() * moves);
  const double told = (moves - places * followed).norm();
  const double nearness = std::min(sigma / told, scale / (2 * PictureScale(window).half));
  return std::hypot(by_residuals, followed.topRows(3).norm() * nearness / scale);
}

double median_miss_px(const Camera& camera, const Samples& samples) {
  std::vector<double> misses;
  for (const Sample& s : samples.items) {
    const glm::dvec3 p = camera.to_camera(samples.centre + samples.scale * s.p);
    misses.push_back(glm::distance(camera.project(p), s.pixel));
  }
  return quantile(misses, 0.5);
}

}  // namespace

std::optional<Camera> fit_camera(const Plane<glm::vec3>& positions,
                                 const Plane<unsigned char>& valid, const Window& window) {
  const Samples samples = collect_samples(positions, valid, window);
  // A plane is flat to the rounding of float: 1e-5 of its extent.
  if (samples.items.size() < 6 || samples.spread[0] < 1e-5 * samples.spread[2]) return std::nullopt;

  ProjectionModel affine = fit_affine(samples);
  affine = fit_affine(inliers(affine, samples));
  const Samples of_affine = inliers(affine, samples);
  const double affine_rms = reprojection_rms(affine, of_affine);

  ProjectionModel model = direct_linear_transform(samples, window);
  Samples used = samples;
  for (int round = 0; round < 3; ++round) {
    refine(model, used, false);
    used = inliers(model, samples);
    if (used.items.size() < 6) return std::nullopt;
  }
  // Perspective contains the affine camera as a limit, so it fits an orthographic frame as well,
  // with a focal length that means nothing.
  if ((affine_rms < 0.02 || affine_rms <= 1.02 * reprojection_rms(model, used)) &&
      (affine_rms > kNoCameraPx ||
       axes_uncertainty(affine, of_affine, window) < kMostUncertainAxes)) {
    return camera_of(affine, samples, window);
  }
  if (is_flat(model, used) || !(focal_uncertainty(model, used) < 0.01)) return std::nullopt;
  return camera_of(model, samples, window);
}

bool explains(const Camera& camera, const Plane<glm::vec3>& positions,
              const Plane<unsigned char>& valid, const Window& window, double step) {
  const Samples samples = collect_samples(positions, valid, window);
  const double depth = -camera.to_camera(samples.centre).z;
  if (!camera.orthographic && !(depth > 0)) return false;
  return median_miss_px(camera, samples) <
         0.5 + step * camera.fx / (camera.orthographic ? 1.0 : depth);
}

double median_miss_px(const Camera& camera, const Plane<glm::vec3>& positions,
                      const Plane<unsigned char>& valid, const Window& window) {
  return median_miss_px(camera, collect_samples(positions, valid, window));
}

double projective_miss_px(const Plane<glm::vec3>& positions, const Plane<unsigned char>& valid,
                          const Window& window) {
  const Samples samples = collect_samples(positions, valid, window);
  if (samples.items.size() < 6) return INFINITY;
  const PictureScale picture(window);
  const Eigen::Matrix<double, 3, 4> matrix = projective_matrix(samples, picture);
  std::vector<double> misses;
  for (const Sample& s : samples.items) {
    const Vector3d at = matrix * Eigen::Vector4d(s.p.x, s.p.y, s.p.z, 1);
    misses.push_back(picture.half * (at.head<2>() / at.z() - picture.of(s.pixel)).norm());
  }
  return quantile(misses, 0.5);
}

std::optional<Camera> in_own_space(const Camera& projection, const Plane<glm::vec3>& positions,
                                   const Plane<unsigned char>& valid, const Window& window) {
  // The signs of x and y follow from the picture, that of z from surfaces being before the camera.
  std::size_t before = 0, behind = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!valid[i]) continue;
    before += positions[i].z < 0;
    behind += positions[i].z > 0;
  }
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      Camera camera = projection;
      camera.rotation = glm::dmat3(1);
      camera.rotation[0][0] = x, camera.rotation[1][1] = y;
      camera.rotation[2][2] = before >= behind ? 1.0 : -1.0;
      camera.origin = glm::dvec3(0);
      if (explains(camera, positions, valid, window)) return camera;
    }
  }
  return std::nullopt;
}

Residual measure_residual(const Camera& camera, const Plane<glm::vec3>& positions,
                          const Plane<unsigned char>& valid, const Window& window) {
  constexpr float kLeftOut = -1, kMost = 1e38f;
  Plane<float> squares = Plane<float>::like(positions);
  for_each_row(positions.height, [&](int y) {
    for (int x = 0; x < positions.width; ++x) {
      squares(x, y) = kLeftOut;
      if (!valid(x, y)) continue;
      const glm::dvec2 at = camera.project(camera.to_camera(glm::dvec3(positions(x, y)))),
                       off = at - glm::dvec2(window.x0 + x + 0.5, window.y0 + y + 0.5);
      const auto square = float(glm::dot(off, off));
      squares(x, y) = square < kMost ? square : kMost;
    }
  });
  const OrderStatistics in_order(squares.pixels);
  if (in_order.count() == 0) return {};
  const auto at = [&](std::size_t place) { return std::sqrt(double(in_order.at(place))); };
  const auto count = double(in_order.count());
  return {at(std::size_t(0.5 * count)), at(std::size_t(0.99 * count)), at(in_order.count() - 1)};
}

}  // namespace ssdo
