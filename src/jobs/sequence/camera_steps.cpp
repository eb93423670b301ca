// SPDX-License-Identifier: Apache-2.0
#include "jobs/sequence/camera_steps.h"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ssdo {
namespace {

// A jump: its least length in widths of the picture; how much farther it leads than the steps
// around it; how many of these are looked at on each side; how far apart in time its frames may be.
constexpr double kLeastWidths = 0.25, kTimesFarther = 3;
constexpr std::ptrdiff_t kAround = 4;
constexpr int kMostApart = 4;

double widths_per_frame(const CameraStep& step) { return step.widths / (step.to - step.from); }

/// The median of the steps around the one at `at`, per frame; 0 where there are none.
double median_around(const std::vector<CameraStep>& steps, std::ptrdiff_t at) {
  std::vector<double> around;
  const auto end = std::min(at + kAround + 1, std::ptrdiff_t(steps.size()));
  for (std::ptrdiff_t i = std::max(std::ptrdiff_t(0), at - kAround); i < end; ++i)
    if (i != at) around.push_back(widths_per_frame(steps[std::size_t(i)]));
  if (around.empty()) return 0;
  std::ranges::sort(around);
  return around[around.size() / 2];
}

}  // namespace

double widths_between(const CameraOfFrame& before, const CameraOfFrame& now) {
  const Window &a = before.display, &b = now.display;
  double sum = 0;
  for (int k = 0; k < 9; ++k) {
    const int column = k % 3, row = k / 3;
    const double x = 0.5 * column, y = 0.5 * row;  // 0 to 1 over the picture
    const glm::dvec3 seen =
        before.camera.unproject({a.x0 + x * a.width(), a.y0 + y * a.height()}, before.depth);
    const glm::dvec3 point = glm::transpose(before.camera.rotation) * seen + before.camera.origin;
    const glm::dvec3 in_now = now.camera.to_camera(point);
    if (!now.camera.orthographic && in_now.z >= 0) {
      sum += 1;
      continue;
    }
    const glm::dvec2 place = now.camera.project(in_now);
    const double ratio = double(b.height()) / b.width();
    const glm::dvec2 moved = {(place.x - b.x0) / b.width() - x,
                              ((place.y - b.y0) / b.height() - y) * ratio};
    sum += std::min(1.0, glm::length(moved));
  }
  return sum / 9;
}

std::vector<CameraStep> camera_steps(std::vector<CameraOfFrame> cameras) {
  std::ranges::sort(cameras, {}, &CameraOfFrame::number);
  std::vector<CameraStep> steps;
  for (std::size_t i = 1; i < cameras.size(); ++i) {
    if (cameras[i].number == cameras[i - 1].number) continue;
    steps.push_back(
        {cameras[i - 1].number, cameras[i].number, widths_between(cameras[i - 1], cameras[i])});
  }
  for (std::size_t i = 0; i < steps.size(); ++i) {
    CameraStep& step = steps[i];
    step.jumps = step.to - step.from <= kMostApart && step.widths > kLeastWidths &&
                 widths_per_frame(step) > kTimesFarther * median_around(steps, std::ptrdiff_t(i));
  }
  return steps;
}

}  // namespace ssdo
