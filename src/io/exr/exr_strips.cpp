// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr_strips.h"

#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "math/half_color.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

// A whole number of chunks of every compression (1, 16, 32 or 256 lines), and enough of them to
// keep the thread pool busy.
constexpr int kStripRows = 256;

constexpr float kLargestHalf = HalfColor::kMost;

/// Clamps and rounds `count` values that are `step` apart. Returns how many were clamped.
std::size_t round_to_half(const float* values, int step, std::size_t count, half* rounded) {
  std::size_t clamped = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float value = values[i * std::size_t(step)];
    clamped += std::abs(value) > kLargestHalf;  // false for NaN, which stays
    rounded[i] = half(value > kLargestHalf ? kLargestHalf : std::max(value, -kLargestHalf));
  }
  return clamped;
}

void copy_values(const float* values, int step, std::size_t count, float* to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = values[i * std::size_t(step)];
}

[[noreturn]] void fail_by_defect(const ExrOutput& output, const std::string& reason) {
  throw Error(ExitCode::failed, fmt::format("{}: {}; this is a defect in ssdo: please report it",
                                            output.input->path().string(), reason));
}

}  // namespace

ExrStrips::ExrStrips(const ExrOutput& output, Imf::FrameBuffer kept, WriteRows write_rows)
    : output_(output),
      known_(known_window(output, part_of(output))),
      written_(written_window(output, part_of(output))),
      slices_(std::move(kept)),
      write_rows_(std::move(write_rows)),
      strip_(output.planes.size()),
      y_(known_.y0) {}

std::size_t ExrStrips::write(std::span<const ChannelView> planes) {
  check(planes);
  const int end = y_ + planes.front().height;
  std::size_t clamped = 0;
  for (int y = std::max(y_, written_.y0); y < std::min(end, written_.y1);) {
    const int rows = std::min(kStripRows - filled_, std::min(end, written_.y1) - y);
    clamped += fill(planes, y, rows);
    y += rows;
    if (filled_ == kStripRows || y == written_.y1) hand_on(y);
  }
  y_ = end;
  // The caller may need the memory before the next call.
  if (filled_ == 0) strip_.assign(planes.size(), {});
  return clamped;
}

void ExrStrips::finish() const {
  if (!is_complete())
    fail_by_defect(output_, fmt::format("{} rows of the output are missing", known_.y1 - y_));
}

void ExrStrips::check(std::span<const ChannelView> planes) const {
  if (planes.size() != output_.planes.size() || planes.empty()) {
    fail_by_defect(output_, fmt::format("{} planes came for the {} of the output", planes.size(),
                                        output_.planes.size()));
  }
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const int width = planes[i].width, height = planes[i].height;
    if (width == known_.width() && height == planes[0].height && height <= known_.y1 - y_) continue;
    fail_by_defect(output_, fmt::format("plane '{}' is {}x{}, the output of part {} is {}x{} from "
                                        "row {} on",
                                        output_.planes[i].name, width, height, output_.part,
                                        known_.width(), known_.y1 - y_, y_));
  }
}

/// Appends rows of the written window, from `y` on, to the strip.
std::size_t ExrStrips::fill(std::span<const ChannelView> planes, int y, int rows) {
  const auto columns = std::size_t(written_.width());
  std::atomic<std::size_t> clamped = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const ChannelView& plane = planes[i];
    const Imf::PixelType type = output_.planes[i].type;
    const std::size_t row_bytes = columns * bytes_of(type);
    strip_[i].resize(std::size_t(std::min(kStripRows, written_.y1 - (y - filled_))) * row_bytes);
    for_each_row(rows, [&](int row) {
      const float* from = plane.at(written_.x0 - known_.x0, y + row - y_);
      std::byte* to = &strip_[i][std::size_t(filled_ + row) * row_bytes];
      if (type == Imf::HALF)
        clamped += round_to_half(from, plane.step, columns, reinterpret_cast<half*>(to));
      else
        copy_values(from, plane.step, columns, reinterpret_cast<float*>(to));
    });
  }
  filled_ += rows;
  return clamped;
}

/// Passes the rows of the strip to `write_rows_`; the last one is the row before `end`.
void ExrStrips::hand_on(int end) {
  const Imath::Box2i window({written_.x0, end - filled_}, {written_.x1 - 1, end - 1});
  for (std::size_t i = 0; i < strip_.size(); ++i) {
    const ExrPlane& plane = output_.planes[i];
    slices_.insert(plane.name, Imf::Slice::Make(plane.type, strip_[i].data(), window));
  }
  write_rows_(slices_, filled_);
  filled_ = 0;
}

}  // namespace ssdo
