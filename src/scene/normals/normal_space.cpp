// SPDX-License-Identifier: Apache-2.0
//
// The space of stored normals is found by what P shows. The gradient of P is the normal of the
// geometry, exactly, where P is smooth: where three pixels in a row and three in a column lie on a
// line each. Shading normals may differ from it (smooth normals on a coarse mesh by up to 40
// degrees, bumps by as much), but rarely by more. On the frames of data/ and on five more scenes of
// Cycles, N is within 53 degrees of the gradient in 99.3 to 100 % of the smooth pixels, N of a
// frame shifted by 10 pixels in 77 to 97 %, by 40 pixels in 51 to 87 %, and N with other axes in 0
// to 97 %; a closed box looks the same under several.
//
// Normals are compared without their sign, since some renderers leave those of back faces as they
// are: two maps of axes that differ by the sign alone are one candidate, whose sign is decided
// last.
#include "scene/normals/normal_space.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>
#include <vector>

#include "scene/camera/projection_model.h"
#include "scene/normals/normals.h"
#include "scene/normals/smooth_gradient.h"

namespace ssdo {
namespace {

constexpr std::size_t kMostSamples = 6000;

constexpr float kWithin = 0.6f;  ///< cosine of 53 degrees
constexpr float kClose = 0.9f;   ///< of 25 degrees

/// If a smaller share of the normals points to the side that P shows, all are turned round.
constexpr double kMostPositive = 0.1;

/// At one pixel, a space is better than another if its cosine is larger by kBetter. It replaces the
/// named space if it is better at more than kTimesBetter times as many pixels as it is worse, plus
/// kLeastBetter, plus one in kSmallestShare of all.
constexpr float kBetter = 0.1f;
constexpr std::size_t kTimesBetter = 3, kLeastBetter = 8, kSmallestShare = 500;

/// Two named spaces are compared at the pixels where their normals differ by more than 2 degrees.
/// One is clearly nearer to the gradient of P if its median angle is below this share of the
/// other's.
constexpr float kClearlyNearer = 0.5f;

/// Rotations below 2 degrees count as none: precision and shading cause as much.
const float kLeastTurn = std::cos(glm::radians(2.0f));
constexpr int kFitRounds = 12;
constexpr double kOutliers = 0.2;           ///< share of the pixels that is left out
constexpr double kWeightOfIdentity = 1e-5;  ///< per pixel

bool is_usable(const glm::vec3& n) {
  const float length = glm::dot(n, n);
  return length > 1e-8f && length < 1e8f;
}

/// A smooth pixel, where the stored normal can be compared with the gradient of P.
struct Witness {
  glm::vec3 gradient, stored;  ///< unit; in camera space, and as stored
};

std::vector<Witness> collect_witnesses(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                                       bool orthographic) {
  std::vector<Witness> witnesses;
  const std::size_t stride = (surfels.size() / kMostSamples) | 1;
  for (std::size_t i = 0; i < surfels.size(); i += stride) {
    if (!surfels[i].is_surface() || !is_usable(stored[i])) continue;
    const int x = int(i % std::size_t(surfels.width)), y = int(i / std::size_t(surfels.width));
    const glm::vec3 view = direction_to_viewer(surfels[i].position, orthographic);
    if (const auto gradient = smooth_gradient(surfels, x, y, view))
      witnesses.push_back({*gradient, glm::normalize(stored[i])});
  }
  return witnesses;
}

/// A map of axes: component i of a normal is sign[i] times the stored component source[i].
struct Axes {
  std::array<int, 3> source{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};

  glm::mat3 matrix() const {
    glm::mat3 m(0);
    for (int i = 0; i < 3; ++i) m[source[std::size_t(i)]][i] = float(sign[std::size_t(i)]);
    return m;
  }

  Axes turned() const { return {source, {-sign[0], -sign[1], -sign[2]}}; }

  /// "" for the axes as they are, else ", axes (x, -z, y)".
  std::string text() const {
    if (matrix() == glm::mat3(1)) return "";
    std::string list;
    for (std::size_t i = 0; i < 3; ++i) {
      list += fmt::format("{}{}{}", i ? ", " : "", sign[i] < 0 ? "-" : "", "xyz"[source[i]]);
    }
    return ", axes (" + list + ")";
  }
};

/// The 24 maps that differ by more than the sign of all; the identity first.
std::vector<Axes> maps_of_axes() {
  std::vector<Axes> all;
  std::array<int, 3> source{0, 1, 2};
  do {
    for (const int y : {1, -1})
      for (const int z : {1, -1}) all.push_back({source, {1, y, z}});
  } while (std::next_permutation(source.begin(), source.end()));
  return all;
}

constexpr const char* kTurnedRound = ", turned round";

/// A map of stored normals to camera space.
struct Candidate {
  std::string space;
  Axes axes;
  glm::mat3 to_camera;
  std::vector<float> cosines;  ///< of the witnesses, signed
  bool is_own = false;
  bool is_turned = false;  ///< points the other way in the rest of the shot

  Candidate(const NamedRotation& in_space, const Axes& by_axes,
            const std::vector<Witness>& witnesses)
      : space(in_space.name), axes(by_axes), to_camera(in_space.to_camera * by_axes.matrix()) {
    for (const Witness& w : witnesses)
      cosines.push_back(glm::dot(w.gradient, to_camera * w.stored));
  }

  std::string name() const { return space + axes.text(); }
  std::string turned_name() const {
    return space + (axes.text().empty() ? kTurnedRound : axes.turned().text());
  }

  /// Share of the witnesses whose normal, without its sign, is nearer than this cosine.
  double share_within(float cosine) const {
    const auto within = std::count_if(cosines.begin(), cosines.end(),
                                      [=](float c) { return std::abs(c) > cosine; });
    return double(within) / double(std::max<std::size_t>(cosines.size(), 1));
  }

  double mean() const {
    double sum = 0;
    for (const float c : cosines) sum += std::abs(c);
    return sum / double(std::max<std::size_t>(cosines.size(), 1));
  }
};

/// The angle between two lines, in radians, by its cosine.
double angle_of(float cosine) { return std::acos(std::min(1.0, double(std::abs(cosine)))); }

/// How many of so many pixels a finding has to hold at to be no accident.
std::size_t enough_of(std::size_t pixels) { return kLeastBetter + pixels / kSmallestShare; }

/// Whether `other` agrees with P at clearly more pixels than `rule`.
bool is_clearly_better(const Candidate& other, const Candidate& rule) {
  std::size_t better = 0, worse = 0;
  for (std::size_t i = 0; i < rule.cosines.size(); ++i) {
    const float gain = std::abs(other.cosines[i]) - std::abs(rule.cosines[i]);
    better += gain > kBetter;
    worse += gain < -kBetter;
  }
  return better > kTimesBetter * worse + enough_of(rule.cosines.size());
}

/// Whether the normals of `other` are clearly nearer to the gradient of P than those of `first`,
/// where the two differ. The answer is no where bumps and smooth normals hide a small rotation.
bool is_clearly_nearer(const Candidate& other, const Candidate& first,
                       const std::vector<Witness>& witnesses) {
  std::vector<double> of_other, of_first;
  for (std::size_t i = 0; i < witnesses.size(); ++i) {
    const glm::vec3& n = witnesses[i].stored;
    if (glm::dot(other.to_camera * n, first.to_camera * n) > kLeastTurn) continue;
    of_other.push_back(angle_of(other.cosines[i])), of_first.push_back(angle_of(first.cosines[i]));
  }
  return of_first.size() > enough_of(witnesses.size()) &&
         quantile(of_other, 0.5) < kClearlyNearer * quantile(of_first, 0.5);
}

/// Share of the witnesses where N is close to the gradient, and differs from the prevailing N of
/// such pixels by more than 25 degrees.
double turning_share(const Candidate& candidate, const std::vector<Witness>& witnesses) {
  std::vector<glm::vec3> close;
  glm::vec3 sum(0);
  for (std::size_t i = 0; i < witnesses.size(); ++i) {
    if (std::abs(candidate.cosines[i]) <= kClose) continue;
    close.push_back(witnesses[i].stored), sum += close.back();
  }
  const float length = glm::length(sum);
  const auto turning = std::count_if(close.begin(), close.end(), [&](const glm::vec3& n) {
    return glm::dot(n, sum) < kClose * length;
  });
  return double(turning) / double(std::max<std::size_t>(witnesses.size(), 1));
}

NormalSpace described(const Candidate& found, const std::vector<Witness>& witnesses) {
  const auto positive =
      std::count_if(found.cosines.begin(), found.cosines.end(), [](float c) { return c > 0; });
  const std::size_t count = found.cosines.size();
  NormalSpace space{found.to_camera, found.name(), count};
  space.share = found.share_within(kWithin);
  space.close_share = found.share_within(kClose);
  space.turning_share = turning_share(found, witnesses);
  space.mean_cosine = found.mean();
  space.is_own = found.is_own;
  // The normals of leaves may rightly point away from a viewer who is below the crown.
  const bool as_they_are = found.axes.text().empty();
  const bool by_shot = found.is_turned && count < NormalSpace::kFewestSmoothPixels;
  if (by_shot || double(positive) < (as_they_are ? kMostPositive : 0.5) * double(count)) {
    space.to_camera = -space.to_camera;
    space.name = found.turned_name();
  }
  return space;
}

/// Whether N agrees with P by enough for the axes to be no accident: a constant N, turned to the
/// viewer, is within 25 degrees of upright blades of grass in 42 % of their pixels.
bool is_known(const Candidate& candidate, const std::vector<Witness>& witnesses) {
  return described(candidate, witnesses).is_known();
}

/// The space, with its axes unchanged, that fits P: the first, unless another is clearly nearer.
Candidate named_space(const std::vector<NamedRotation>& spaces,
                      const std::vector<Witness>& witnesses) {
  Candidate found(spaces[0], {}, witnesses);
  for (const NamedRotation& space : spaces) {
    Candidate other(space, {}, witnesses);
    if (is_known(other, witnesses) && is_clearly_nearer(other, found, witnesses))
      found = std::move(other);
  }
  return found;
}

/// The space and axes whose name `text` begins with; else `rule`.
Candidate named_in(const std::string& text, const std::vector<NamedRotation>& spaces,
                   const std::vector<Witness>& witnesses, const Candidate& rule) {
  Candidate found = rule;
  std::size_t longest = 0;
  for (const NamedRotation& space : spaces) {
    for (const Axes& axes : maps_of_axes()) {
      Candidate candidate(space, axes, witnesses);
      for (const bool turned : {false, true}) {
        const std::string name = turned ? candidate.turned_name() : candidate.name();
        if (name.size() <= longest || !text.starts_with(name)) continue;
        longest = name.size(), found = candidate, found.is_turned = turned;
      }
    }
  }
  return found;
}

/// The rotation that brings the mapped normals closest to the gradients: Wahba's problem, solved by
/// a singular value decomposition (Markley 1988), and solved again by the pixels that agree best,
/// so that bumps and smooth normals count little. A rotation about a normal that all pixels share
/// cannot be observed: the small weight of the identity sets it to zero.
glm::mat3 rotation_to_gradients(const Candidate& candidate, const std::vector<Witness>& witnesses) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  for (int round = 0; round < kFitRounds; ++round) {
    std::vector<Eigen::Vector3d> mapped, gradients;
    std::vector<double> cosines;
    for (const Witness& w : witnesses) {
      const glm::dvec3 n(candidate.to_camera * w.stored), g(w.gradient);
      mapped.push_back(turn * Eigen::Vector3d(n.x, n.y, n.z));
      gradients.emplace_back(g.x, g.y, g.z);
      cosines.push_back(gradients.back().dot(mapped.back()));
    }
    std::vector<double> sizes;
    for (const double c : cosines) sizes.push_back(std::abs(c));
    const double least = quantile(sizes, kOutliers);
    Eigen::Matrix3d products =
        kWeightOfIdentity * double(witnesses.size()) * Eigen::Matrix3d::Identity();
    for (std::size_t i = 0; i < witnesses.size(); ++i) {
      if (sizes[i] < least) continue;
      products += (cosines[i] < 0 ? -1.0 : 1.0) * gradients[i] * mapped[i].transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(products,
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d &u = svd.matrixU(), &v = svd.matrixV();
    const Eigen::Vector3d proper(1, 1, (u * v.transpose()).determinant() < 0 ? -1 : 1);
    turn = u * proper.asDiagonal() * v.transpose() * turn;
  }
  glm::mat3 rotation;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) rotation[column][row] = float(turn(row, column));
  return rotation;
}

/// The candidate rotated to fit P, if that turns it by 2 degrees or more and brings the pixels that
/// it moves much closer; else as it is. For a space of its own, such as a world of unknown pose.
Candidate turned_to_gradients(Candidate candidate, const std::vector<Witness>& witnesses) {
  if (witnesses.empty()) return candidate;
  const glm::mat3 turn = rotation_to_gradients(candidate, witnesses);
  const float cosine = 0.5f * (turn[0][0] + turn[1][1] + turn[2][2] - 1);
  const std::string name =
      fmt::format("a space of its own, {:.0f} degrees from {}",
                  glm::degrees(std::acos(std::clamp(cosine, -1.0f, 1.0f))), candidate.name());
  Candidate turned({turn * candidate.to_camera, name}, {}, witnesses);
  turned.is_own = true;
  const bool is_nearer = cosine < kLeastTurn && is_known(turned, witnesses) &&
                         is_clearly_nearer(turned, candidate, witnesses);
  return is_nearer ? turned : candidate;
}

}  // namespace

NormalSpace find_normal_space(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                              const std::vector<NamedRotation>& spaces, bool orthographic,
                              const std::string& of_shot) {
  const std::vector<Witness> witnesses = collect_witnesses(stored, surfels, orthographic);
  Candidate rule = named_space(spaces, witnesses);
  if (!of_shot.empty()) rule = named_in(of_shot, spaces, witnesses, rule);
  Candidate best = rule;
  for (const NamedRotation& space : spaces) {
    for (const Axes& axes : maps_of_axes()) {
      Candidate candidate(space, axes, witnesses);
      if (candidate.mean() > best.mean()) best = std::move(candidate);
    }
  }
  const bool is_better = is_known(best, witnesses) && is_clearly_better(best, rule);
  return described(turned_to_gradients(is_better ? best : rule, witnesses), witnesses);
}

NormalSpace measure_normal_space(const Plane<glm::vec3>& stored, const Surfaces& surfels,
                                 const NamedRotation& space, bool orthographic) {
  const std::vector<Witness> witnesses = collect_witnesses(stored, surfels, orthographic);
  NormalSpace measured = described(Candidate(space, {}, witnesses), witnesses);
  measured.to_camera = space.to_camera;
  measured.name = space.name;
  return measured;
}

}  // namespace ssdo
