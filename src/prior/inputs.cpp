// SPDX-License-Identifier: Apache-2.0
#include "prior/inputs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "estimators/guessed.h"

namespace ssdo {
namespace {

/// Width of the strip along a side, over the geometric mean of the frame's width and height.
constexpr double kSideWidth = 1.0 / 12;

/// Weight of the frame's mean in a strip, where a strip that shows nothing but surfaces has 1.
constexpr float kOfTheFrame = 1e-3f;

/// Limits of the inputs for distance and radius, in halves of their logarithms.
constexpr float kMostLogDepth = 3, kMostLogRadius = 1.5f;

/// Sums over the surfaces of a part of the frame.
struct Sums {
  std::array<double, PriorContext::kValues> of = {};
  double surfaces = 0, count = 0;

  void add_surface(const PriorContext::Values& values) {
    surfaces += 1;
    for (std::size_t c = 0; c < values.size(); ++c) of[c] += double(values[c]);
  }
  float covered() const { return float(surfaces / std::max(count, 1.0)); }
};

float deviation(float mean_of_square, float mean) {
  return std::sqrt(std::max(mean_of_square - mean * mean, 0.0f));
}

}  // namespace

glm::mat3 prior_axes(const std::optional<glm::vec3>& up) {
  const glm::vec3 forward(0, 0, -1), top(0, 1, 0);
  if (!up) return glm::transpose(glm::mat3(glm::vec3(1, 0, 0), forward, top));
  // Seen from above, the top of the picture points ahead; from below, back.
  const auto level = [&](const glm::vec3& v) { return v - glm::dot(v, *up) * *up; };
  const glm::vec3 ahead = level(forward) - glm::dot(forward, *up) * level(top);
  const float length = glm::length(ahead);
  // A camera on its side that looks along the vertical has no way ahead.
  const glm::vec3 y = length > 1e-3f ? ahead / length : glm::normalize(level({0.8f, 0.5f, 0.3f}));
  return glm::transpose(glm::mat3(glm::cross(y, *up), y, *up));
}

PriorInputs::PriorInputs(const PriorGrid& grid, const Geometry& geometry,
                         const std::optional<glm::vec3>& up, float radius,
                         const PriorContext* of_frame)
    : grid_(grid),
      axes_(prior_axes(up)),
      orthographic_(geometry.camera.orthographic),
      pitch_(up ? -up->z : 0.0f),
      radius_(radius) {
  const Camera& camera = geometry.camera;
  const double width = geometry.display.width(), height = geometry.display.height();
  lens_ = float(std::sqrt(width / 2 / camera.fx * (height / 2 / camera.fy)));
  log_lens_ = orthographic_ ? -3.0f : std::clamp(std::log(lens_), -3.0f, 1.0f);
  log_aspect_ = float(std::log(width / height));
  if (of_frame) context_ = *of_frame;
  find_log_depth(of_frame != nullptr);
  if (!of_frame) find_means(width / height);
  share();
}

/// Half of the logarithm of the depth over its geometric mean; orthographic: of the depth less its
/// mean, in halves of the picture. 0 without a surface.
void PriorInputs::find_log_depth(bool is_known) {
  const auto of = [&](const Surfel& s) {
    return orthographic_ ? -s.position.z / (4 * lens_) : 0.5f * std::log(-s.position.z);
  };
  log_depth_ = Plane<float>(grid_.pixel.width, grid_.pixel.height, 0.0f);
  double sum = 0, count = 0;
  for (int y = 0; y < log_depth_.height; ++y) {
    for (int x = 0; x < log_depth_.width; ++x) {
      if (grid_.pixel(x, y) == kNoPixel) continue;
      log_depth_(x, y) = of(grid_.surfaces(x, y));
      if (grid_.covered(x, y) == 0 || !grid_.in_display(x, y)) continue;
      sum += double(log_depth_(x, y)), count += 1;
    }
  }
  if (!is_known) context_.mean_log_depth = float(count > 0 ? sum / count : 0);
  const float mean = context_.mean_log_depth;
  for (std::size_t i = 0; i < log_depth_.size(); ++i) {
    if (grid_.pixel[i] != kNoPixel)
      log_depth_[i] = std::clamp(log_depth_[i] - mean, -kMostLogDepth, kMostLogDepth);
  }
}

PriorInputs::Values PriorInputs::values_of(int x, int y) const {
  const std::size_t i = grid_.ao.index(x, y);
  const glm::vec3 normal = axes_ * grid_.surfaces[i].normal, bent = axes_ * grid_.bent[i];
  const float ao = grid_.ao[i], depth = log_depth_[i], guessed = grid_.guessed[i];
  return {normal.x,      normal.y, normal.z, std::abs(normal.z),    depth,
          depth * depth, ao,       guessed,  grid_.open_ao[i] - ao, bent.x,
          bent.y,        bent.z,   ao * ao,  guessed * guessed};
}

void PriorInputs::find_means(double aspect) {
  const double strip_across = kSideWidth / std::sqrt(aspect),
               strip_down = kSideWidth * std::sqrt(aspect);
  Sums frame, sides[4];
  for (int y = 0; y < grid_.pixel.height; ++y) {
    for (int x = 0; x < grid_.pixel.width; ++x) {
      if (!grid_.in_display(x, y)) continue;
      const bool is_surface = grid_.covered(x, y) != 0;
      const Values values = is_surface ? values_of(x, y) : Values();
      const auto count = [&](Sums& sums) {
        sums.count += 1;
        if (is_surface) sums.add_surface(values);
      };
      count(frame);
      // Shares of the frame to the left and above.
      const double right = (grid_.first.x + x + 0.5) / grid_.display.x,
                   low = (grid_.first.y + y + 0.5) / grid_.display.y;
      const double inwards[4] = {low, 1 - low, right, 1 - right};
      for (int k = 0; k < 4; ++k)
        if (inwards[k] < (k < 2 ? strip_down : strip_across)) count(sides[k]);
    }
  }
  context_.frame.covered = frame.covered();
  for (std::size_t c = 0; c < frame.of.size(); ++c)
    context_.frame.of[c] = float(frame.of[c] / std::max(frame.surfaces, 1.0));
  for (std::size_t k = 0; k < 4; ++k) {
    PriorContext::Means& side = context_.sides[k];
    side.covered = sides[k].covered();
    for (std::size_t c = 0; c < side.of.size(); ++c) {
      const auto sum = float(sides[k].of[c] / std::max(sides[k].count, 1.0));
      side.of[c] = (sum + kOfTheFrame * context_.frame.of[c]) / (side.covered + kOfTheFrame);
    }
  }
}

void PriorInputs::share() {
  const auto put = [&](float value) { shared_.push_back(value); };
  const Values& f = context_.frame.of;
  for (int c = 0; c < 3; ++c) put(f[std::size_t(c)]);
  put(glm::length(glm::vec3(f[0], f[1], f[2])));
  put(f[PriorContext::kLevel]);
  put(deviation(f[PriorContext::kLogDepth2], f[PriorContext::kLogDepth]));
  put(context_.frame.covered);
  for (std::size_t c = PriorContext::kAo; c < PriorContext::kAo2; ++c) put(f[c]);
  put(deviation(f[PriorContext::kAo2], f[PriorContext::kAo]));
  put(deviation(f[PriorContext::kGuessed2], f[PriorContext::kGuessed]));
  put(pitch_);
  for (const PriorContext::Means& side : context_.sides) {
    put(side.covered);
    for (const int c :
         {int(PriorContext::kLogDepth), PriorContext::kNormal + 2, int(PriorContext::kAo),
          int(PriorContext::kGuessed), int(PriorContext::kOpen)})
      put(side.of[std::size_t(c)]);
  }
}

void PriorInputs::write(int y, std::size_t stride, float* rows) const {
  for (int x = 0; x < grid_.pixel.width; ++x) {
    if (grid_.pixel(x, y) == kNoPixel) continue;
    float* to = rows + x;
    const auto put = [&](float value) { *to = value, to += stride; };
    const Values own = values_of(x, y);
    const Surfel& s = grid_.surfaces(x, y);
    const float extent = orthographic_ ? lens_ : -s.position.z * lens_,
                across = (float(grid_.first.x + x) + 0.5f) / float(grid_.display.x),
                down = (float(grid_.first.y + y) + 0.5f) / float(grid_.display.y);
    const glm::vec3 normal(own[0], own[1], own[2]),
        view = axes_ * (orthographic_ ? glm::vec3(0, 0, -1) : glm::normalize(s.position));
    for (const PriorContext::Value c :
         {PriorContext::kAo, PriorContext::kGuessed, PriorContext::kOpen})
      put(own[c]);
    put(std::isinf(radius_)
            ? kMostLogRadius
            : std::clamp(0.5f * std::log(radius_ / extent), -kMostLogRadius, kMostLogRadius));
    for (std::size_t c = PriorContext::kBent; c < PriorContext::kBent + 3; ++c) put(own[c]);
    for (int c = 0; c < 3; ++c) put(normal[c]);
    for (int c = 0; c < 3; ++c) put(view[c]);
    put(2 * across - 1), put(1 - 2 * down);
    put(own[PriorContext::kLogDepth]);
    put(-glm::dot(normal, view));
    put(log_lens_), put(log_aspect_);
  }
}

}  // namespace ssdo
