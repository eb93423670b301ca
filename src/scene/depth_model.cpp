// SPDX-License-Identifier: Apache-2.0
#include "scene/depth_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "scene/camera/projection_model.h"
#include "scene/marked_pixels.h"

namespace ssdo {

struct DepthSample {
  glm::dvec3 p;  ///< from the centre
  double depth;
};

namespace {

constexpr std::size_t kMostSamples = 20000;
constexpr int kRounds = 4;  ///< of leaving out outliers
constexpr double kTolerance = 0.05;
constexpr double kExact =
    1e-5;  ///< a smaller median miss leaves nothing for another kind to explain

/// Share of the pixels with a depth that has to agree: averaged silhouettes do not, and in grass
/// they may be a third of the frame.
constexpr double kLeastShare = 0.5;

/// The gradient of a depth in the units of P has the length 1 to this tolerance. Positions in one
/// plane show only the component of the gradient in that plane, which may be shorter.
constexpr double kUnitLength = 0.05;
constexpr double kFlat = 1e-3;  ///< thickness of such a plane over its extent

/// At most kMostSamples of the pixels that count, spread over the frame.
std::vector<DepthSample> collect(const Plane<glm::vec3>& positions, const Plane<float>& depth,
                                 const Plane<unsigned char>& counts) {
  std::vector<DepthSample> pixels;
  for (const std::size_t i : every_marked(counts, count_marked(counts) / kMostSamples + 1))
    pixels.push_back({glm::dvec3(positions[i]), depth[i]});
  return pixels;
}

/// Least squares for value = affine . (p, 1), relative to the value's size so that no far pixel
/// outweighs the others; the shortest solution where P leaves it open.
glm::dvec4 fit_affine(const std::vector<DepthSample>& pixels, const std::vector<double>& values,
                      const std::vector<double>& sizes, const std::vector<bool>& used) {
  Eigen::Matrix4d ata = Eigen::Matrix4d::Zero();
  Eigen::Vector4d atb = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (!used[i]) continue;
    const double weight = 1 / sizes[i];
    const Eigen::Vector4d row =
        weight * Eigen::Vector4d(pixels[i].p.x, pixels[i].p.y, pixels[i].p.z, 1);
    ata += row * row.transpose();
    atb += row * weight * values[i];
  }
  const Eigen::Vector4d x = ata.completeOrthogonalDecomposition().solve(atb);
  return {x[0], x[1], x[2], x[3]};
}

/// Whether the positions lie in one plane, so that the gradient along its normal is unknown.
bool is_flat(const std::vector<DepthSample>& pixels) {
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const DepthSample& pixel : pixels) {
    const Eigen::Vector3d p(pixel.p.x, pixel.p.y, pixel.p.z);
    moments += p * p.transpose();
  }
  const Eigen::Vector3d spread =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(moments).eigenvalues();
  return !(spread[0] > kFlat * kFlat * spread[2]);
}

}  // namespace

double DepthModel::depth_of(const glm::dvec3& p) const {
  const double value = glm::dot(affine_, glm::dvec4(p, 1));
  return kind_ == DepthKind::planar ? value : std::sqrt(std::max(glm::dot(p, p) + value, 0.0));
}

double DepthModel::length_of_unit() const {
  const double gradient = glm::length(glm::dvec3(affine_));
  // The camera at c: |p - c|^2 = |p|^2 - 2 c p + |c|^2.
  return kind_ == DepthKind::planar ? gradient
                                    : 0.5 * gradient / std::sqrt(std::max(affine_.w, 1e-300));
}

bool DepthModel::agrees(const glm::vec3& position, float depth) const {
  const glm::dvec3 size = glm::abs(glm::dvec3(position));
  const double rounding = 2 * position_step_ * std::max({size.x, size.y, size.z});
  // Not-a-number agrees with nothing.
  return std::abs(depth_of(glm::dvec3(position) - centre_) - depth) <=
         kTolerance * depth + rounding;
}

/// The pixels that models are fitted to.
class DepthModel::Fit {
 public:
  Fit(const Plane<glm::vec3>& positions, const Plane<float>& depth,
      const Plane<unsigned char>& counts, float position_step)
      : pixels_(collect(positions, depth, counts)), position_step_(position_step) {
    for (const DepthSample& pixel : pixels_) centre_ += pixel.p / double(pixels_.size());
    for (DepthSample& pixel : pixels_) pixel.p -= centre_;
  }

  /// The model of a kind, if most pixels agree with it.
  std::optional<DepthModel> of_kind(DepthKind kind) const {
    if (pixels_.size() < kFewestPixels) return std::nullopt;
    DepthModel model;
    model.kind_ = kind;
    model.centre_ = centre_;
    model.position_step_ = position_step_;
    fit_affine_part(model);
    std::size_t agreeing = 0;
    for (const DepthSample& pixel : pixels_)
      agreeing += model.agrees(glm::vec3(pixel.p + centre_), float(pixel.depth));
    const bool right = double(agreeing) >= kLeastShare * double(pixels_.size());
    return right ? std::optional(model) : std::nullopt;
  }

  /// Whether depth and P may have the same unit.
  bool has_unit_of_positions(const DepthModel& model) const {
    const double length = model.length_of_unit();
    return length < 1 + kUnitLength && (is_flat(pixels_) || length > 1 - kUnitLength);
  }

  /// Median over the pixels, relative to their depth.
  double miss_of(const DepthModel& model) const { return quantile(misses_of(model), 0.5); }

 private:
  std::vector<double> misses_of(const DepthModel& model) const {
    std::vector<double> misses;
    for (const DepthSample& pixel : pixels_)
      misses.push_back(std::abs(model.depth_of(pixel.p) - pixel.depth) / pixel.depth);
    return misses;
  }

  void fit_affine_part(DepthModel& model) const {
    std::vector<double> values, sizes;
    for (const DepthSample& pixel : pixels_) {
      const bool planar = model.kind_ == DepthKind::planar;
      sizes.push_back(planar ? pixel.depth : pixel.depth * pixel.depth);
      values.push_back(planar ? pixel.depth : sizes.back() - glm::dot(pixel.p, pixel.p));
    }
    std::vector<bool> used(pixels_.size(), true);
    for (int round = 0; round < kRounds; ++round) {
      model.affine_ = fit_affine(pixels_, values, sizes, used);
      const std::vector<double> misses = misses_of(model);
      // A miss of more than three times the median is another surface, or an average over an edge.
      const double limit = std::max(3 * quantile(misses, 0.5), kTolerance);
      for (std::size_t i = 0; i < pixels_.size(); ++i) used[i] = misses[i] <= limit;
    }
  }

  std::vector<DepthSample> pixels_;
  glm::dvec3 centre_{0};
  double position_step_;
};

std::optional<DepthModel> DepthModel::fit(const Plane<glm::vec3>& positions,
                                          const Plane<float>& depth,
                                          const Plane<unsigned char>& counts, float position_step) {
  const Fit fit(positions, depth, counts, position_step);
  std::optional<DepthModel> best;
  for (const DepthKind kind : {DepthKind::planar, DepthKind::ray}) {
    const auto model = fit.of_kind(kind);
    if (!model || !fit.has_unit_of_positions(*model)) continue;
    if (!best || fit.miss_of(*model) < fit.miss_of(*best)) best = model;
    if (fit.miss_of(*best) < kExact) break;
  }
  return best;
}

std::optional<DepthModel> DepthModel::fit_in_any_unit(const Plane<glm::vec3>& positions,
                                                      const Plane<float>& depth,
                                                      const Plane<unsigned char>& counts,
                                                      float position_step) {
  return Fit(positions, depth, counts, position_step).of_kind(DepthKind::planar);
}

}  // namespace ssdo
