// SPDX-License-Identifier: Apache-2.0
#include "prior/inputs.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "estimators/guessed.h"

namespace ssdo {
namespace {

/// Cells across a square frame, and the factor of their size at each scale.
constexpr double kCells = 48;
constexpr std::array kLarger = {1, 4, 12};

/// Weight of the frame's mean in a cell, where a cell that shows nothing but surfaces has 1.
constexpr float kOfTheFrame = 1e-3f;

/// Limits of the inputs for distance and radius, in halves of their logarithms.
constexpr float kMostLogDepth = 3, kMostLogRadius = 1.5f;

int count_of(double cells, int larger, int most) {
  return std::clamp(int(cells / larger + 0.5), 1, most);
}

/// The cell that holds the centre of the i-th of `count` parts of the frame.
int cell_of(int i, int count, int cells) {
  return int((2 * std::int64_t(i) + 1) * cells / (2 * std::int64_t(count)));
}

float deviation(float mean_of_square, float mean) {
  return std::sqrt(std::max(mean_of_square - mean * mean, 0.0f));
}

/// Two neighbours in a row of cells, and how far a place lies from the first to the second.
struct Between {
  int first, second;
  float share;
};
Between between(float at, int count) {
  const float x = std::clamp(at * float(count) - 0.5f, 0.0f, float(count - 1));
  const int first = int(x);
  return {first, std::min(first + 1, count - 1), x - float(first)};
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
  if (!of_frame) find_cells(width / height);
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

void PriorInputs::find_cells(double aspect) {
  struct Sums {
    std::array<double, PriorContext::kValues> of = {};
    double surfaces = 0, count = 0;
  };
  const double across = kCells * std::sqrt(aspect), down = kCells / std::sqrt(aspect);
  const glm::ivec2 all = grid_.display;
  Plane<Sums> sums(count_of(across, 1, all.x), count_of(down, 1, all.y), Sums{});
  Sums frame;
  for (int y = 0; y < grid_.pixel.height; ++y) {
    for (int x = 0; x < grid_.pixel.width; ++x) {
      if (!grid_.in_display(x, y)) continue;
      Sums& cell = sums(cell_of(grid_.first.x + x, all.x, sums.width),
                        cell_of(grid_.first.y + y, all.y, sums.height));
      cell.count += 1, frame.count += 1;
      if (grid_.covered(x, y) == 0) continue;
      cell.surfaces += 1, frame.surfaces += 1;
      const Values values = values_of(x, y);
      for (std::size_t c = 0; c < values.size(); ++c)
        cell.of[c] += double(values[c]), frame.of[c] += double(values[c]);
    }
  }
  const auto cell_with = [](const Sums& sum) {
    const double count = std::max(sum.count, 1.0);
    Cell cell{float(sum.surfaces / count), {}};
    for (std::size_t c = 0; c < sum.of.size(); ++c) cell.sums[c] = float(sum.of[c] / count);
    return cell;
  };
  context_.frame = cell_with(frame);
  for (std::size_t c = 0; c < context_.frame_mean.size(); ++c)
    context_.frame_mean[c] = float(frame.of[c] / std::max(frame.surfaces, 1.0));
  context_.cells[0] = Plane<Cell>(sums.width, sums.height);
  for (std::size_t i = 0; i < sums.size(); ++i) context_.cells[0][i] = cell_with(sums[i]);
  // Larger cells are means of those whose centres they hold.
  for (std::size_t k = 1; k < kScales; ++k) {
    Plane<Sums> larger(count_of(across, kLarger[k], sums.width),
                       count_of(down, kLarger[k], sums.height), Sums{});
    for (int y = 0; y < sums.height; ++y) {
      for (int x = 0; x < sums.width; ++x) {
        Sums& sum =
            larger(cell_of(x, sums.width, larger.width), cell_of(y, sums.height, larger.height));
        const Cell& cell = context_.cells[0](x, y);
        sum.count += 1, sum.surfaces += double(cell.covered);
        for (std::size_t c = 0; c < cell.sums.size(); ++c) sum.of[c] += double(cell.sums[c]);
      }
    }
    context_.cells[k] = Plane<Cell>(larger.width, larger.height);
    for (std::size_t i = 0; i < larger.size(); ++i) context_.cells[k][i] = cell_with(larger[i]);
  }
}

PriorInputs::Values PriorInputs::means(const Cell& cell) const {
  Values mean;
  const float scale = 1 / (cell.covered + kOfTheFrame);
  for (std::size_t c = 0; c < mean.size(); ++c)
    mean[c] = (cell.sums[c] + kOfTheFrame * context_.frame_mean[c]) * scale;
  return mean;
}

/// `across` and `down`: where in the display window, 0..1.
PriorInputs::Cell PriorInputs::look_up(const Plane<Cell>& cells, float across, float down) const {
  const Between u = between(across, cells.width), v = between(down, cells.height);
  const Cell &a = cells(u.first, v.first), &b = cells(u.second, v.first),
             &c = cells(u.first, v.second), &d = cells(u.second, v.second);
  const float of_a = (1 - u.share) * (1 - v.share), of_b = u.share * (1 - v.share),
              of_c = (1 - u.share) * v.share, of_d = u.share * v.share;
  Cell found;
  found.covered = of_a * a.covered + of_b * b.covered + of_c * c.covered + of_d * d.covered;
  for (std::size_t i = 0; i < found.sums.size(); ++i)
    found.sums[i] = of_a * a.sums[i] + of_b * b.sums[i] + of_c * c.sums[i] + of_d * d.sums[i];
  return found;
}

void PriorInputs::share() {
  const auto put = [&](float value) { shared_.push_back(value); };
  const Values& f = context_.frame_mean;
  for (int c = 0; c < 3; ++c) put(f[std::size_t(c)]);
  put(glm::length(glm::vec3(f[0], f[1], f[2])));
  put(f[PriorContext::kLevel]);
  put(deviation(f[PriorContext::kLogDepth2], f[PriorContext::kLogDepth]));
  put(context_.frame.covered);
  for (std::size_t c = PriorContext::kAo; c < PriorContext::kAo2; ++c) put(f[c]);
  put(deviation(f[PriorContext::kAo2], f[PriorContext::kAo]));
  put(deviation(f[PriorContext::kGuessed2], f[PriorContext::kGuessed]));
  put(pitch_);
  // Along a border.
  const Plane<Cell>& cells = context_.cells[1];
  const auto put_side = [&](int count, const auto& at) {
    Cell side;
    const float each = 1 / float(count);
    for (int i = 0; i < count; ++i) {
      const Cell& cell = at(i);
      side.covered += each * cell.covered;
      for (std::size_t c = 0; c < PriorContext::kValues; ++c) side.sums[c] += each * cell.sums[c];
    }
    const Values m = means(side);
    put(side.covered);
    for (const int c :
         {int(PriorContext::kLogDepth), PriorContext::kNormal + 2, int(PriorContext::kAo),
          int(PriorContext::kGuessed), int(PriorContext::kOpen)})
      put(m[std::size_t(c)]);
  };
  put_side(cells.width, [&](int i) -> const Cell& { return cells(i, 0); });
  put_side(cells.width, [&](int i) -> const Cell& { return cells(i, cells.height - 1); });
  put_side(cells.height, [&](int i) -> const Cell& { return cells(0, i); });
  put_side(cells.height, [&](int i) -> const Cell& { return cells(cells.width - 1, i); });
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
    for (const Plane<Cell>& cells : context_.cells) {
      const Cell cell = look_up(cells, across, down);
      const Values m = means(cell);
      for (int c = 0; c < 3; ++c) put(m[std::size_t(c)]);
      put(glm::length(glm::vec3(m[0], m[1], m[2])));
      put(m[PriorContext::kLevel]);
      put(m[PriorContext::kLogDepth] - own[PriorContext::kLogDepth]);
      put(deviation(m[PriorContext::kLogDepth2], m[PriorContext::kLogDepth]));
      put(cell.covered);
      for (const PriorContext::Value c :
           {PriorContext::kAo, PriorContext::kGuessed, PriorContext::kOpen})
        put(m[c]);
      put(m[PriorContext::kBent + 2]);
    }
  }
}

}  // namespace ssdo
