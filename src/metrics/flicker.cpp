// SPDX-License-Identifier: Apache-2.0
//
// Flicker: the change from frame to frame at the same point p of the same surface. Each pixel of
// the present frame is looked for in the frame before, whose camera saw its p at a place p' between
// the centres of four pixels q. It counts where all four show the surface of p,
//
//   N_p . N_q >= 0.95,   |N_p . (q - p)| and |N_q . (q - p)| <= f / 2,
//
// f the width of a pixel at p, and where that surface was at p in the frame before: the bilinear
// mean Q of the four q, which lies on the view ray of p', leaves the tangent plane of p by f / 10
// at most. The rounding of P adds to both limits. A surface that moves leaves the plane, unless it
// moves in it: a motion layer tells that too, by being off from p' by more than a tenth of a pixel.
//
// The frame before is sampled bilinearly too. A layer that is a function of P alone then changes by
// the error of that, which falls with the square of its period in pixels. Measured on three shots
// of Cycles, 24 frames of 320 x 180 a degree apart, with means of three sines that range over 0..1:
//
//   period                  128 px              64 px             32 px
//   four pixels        0.0004 to 0.0012   0.0015 to 0.0039   0.006 to 0.013
//   the nearest one    0.0036 to 0.0078   0.0076 to 0.0155   0.015 to 0.031
//
// Constants change by nothing. Noise of single pixels of standard deviation s changes by 1.2 s, and
// by 1.41 s where the camera rests.
//
// The filters in filters/ have similar rules of their own: the code that is measured has no say in
// where it is measured.
#include "metrics/flicker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

#include "parallel/tiles.h"
#include "scene/camera/camera_change.h"
#include "scene/pixel_footprint.h"

namespace ssdo {
namespace {

constexpr double kSameNormal = 0.95;  ///< normals 18 degrees apart belong to two surfaces
constexpr double kGap = 0.5;          ///< most pixel widths from a pixel to the plane of another
constexpr double kMoved = 0.1;        ///< the same for the mean of the four pixels
constexpr double kOffPixels = 0.1;    ///< most pixels between motion layer and camera motion

/// Places this near to a column or a row of pixel centres, in pixels, are moved onto it, so that a
/// resting camera compares pixels with themselves. P as stored is no more precise.
constexpr double kSnap = 1.0 / 64;

/// Where a place lies along one axis: between the centres of pixel `first` and the next.
struct Between {
  int first;
  float past;
};

Between between_centres(double place) {
  const double first = std::floor(place), past = place - first;
  if (past > 1 - kSnap) return {int(first) + 1, 0};
  return {int(first), past < kSnap ? 0 : float(past)};
}

/// The weights of the four pixels around a point, from the upper left in rows.
struct Corners {
  double weight[4];

  Corners(float across, float down)
      : weight{(1.0 - across) * (1.0 - down), across * (1.0 - down), (1.0 - across) * down,
               double(across) * down} {}
};

/// Finds points of one frame in the frame before.
class Search {
 public:
  Search(const Geometry& before, const Geometry& now)
      : before_(before), now_(now), change_(now.camera, before.camera), footprint_(before.camera) {}

  /// Appends to `found` the point of pixel (x, y) of the present plane if the frame before shows
  /// it, and to `moved` whether `motion` contradicts the place that the cameras give.
  void find(int x, int y, const glm::vec2* motion, std::vector<SharedPoint>& found,
            std::vector<bool>& moved) const {
    const Surfel& surfel = now_.surfaces(x, y);
    if (!surfel.is_usable()) return;
    const glm::dvec3 p = change_.position(surfel.position);
    if (!(before_.camera.depth_of(p) > 0) && !before_.camera.orthographic) return;
    const glm::dvec2 place = before_.camera.project(p);
    const Window& window = before_.window;
    if (!(place.x > window.x0 && place.x < window.x1 && place.y > window.y0 && place.y < window.y1))
      return;
    const Between across = between_centres(place.x - 0.5), down = between_centres(place.y - 0.5);
    const SharedPoint point{now_.window.x0 + x, now_.window.y0 + y, across.first, down.first,
                            across.past,        down.past,          false};
    if (!shows(point, p, surfel)) return;
    const glm::dvec2 centre(point.x + 0.5, point.y + 0.5);
    found.push_back(point);
    found.back().at_border =
        is_at_border(now_.display, centre) || is_at_border(before_.display, place);
    const auto is_off = [&](const glm::dvec2& by_layer) {
      return !(glm::length(by_layer - (place - centre)) <= kOffPixels);
    };
    moved.push_back(motion && is_off(glm::dvec2(*motion)));
  }

 private:
  static bool is_at_border(const Window& display, const glm::dvec2& place) {
    return place.x < display.x0 + kBorder || place.x > display.x1 - kBorder ||
           place.y < display.y0 + kBorder || place.y > display.y1 - kBorder;
  }

  /// Whether the pixels around the point show its surface at its present place.
  bool shows(const SharedPoint& point, const glm::dvec3& p, const Surfel& surfel) const {
    const glm::dvec3 normal = change_.direction(surfel.normal);
    const double width = footprint_.at(float(before_.camera.depth_of(p)));
    const Corners corners(point.across, point.down);
    double leaves = 0,
           rounding = surfel.rounding;  // of the mean of the pixels, from the plane of p
    for (int k = 0; k < 4; ++k) {
      if (corners.weight[k] == 0) continue;
      const int x = point.left + k % 2, y = point.top + k / 2;
      if (!before_.window.contains(x, y)) return false;
      const Surfel& q = before_.surfaces(x - before_.window.x0, y - before_.window.y0);
      if (!q.is_usable()) return false;
      const glm::dvec3 away = glm::dvec3(q.position) - p, other(q.normal);
      const double limit = kGap * width + surfel.rounding + q.rounding;
      if (!(glm::dot(normal, other) >= kSameNormal && std::abs(glm::dot(normal, away)) <= limit &&
            std::abs(glm::dot(other, away)) <= limit))
        return false;
      leaves += corners.weight[k] * glm::dot(normal, away);
      rounding += corners.weight[k] * q.rounding;
    }
    return std::abs(leaves) <= kMoved * width + rounding;
  }

  const Geometry& before_;
  const Geometry& now_;
  const CameraChange change_;
  const PixelFootprint footprint_;
};

/// The value of channel `c` at a point in the frame before; not a number where a pixel is not
/// finite or outside the channels.
double sample(const Channels& channels, std::size_t c, const SharedPoint& point) {
  const Corners corners(point.across, point.down);
  double first = 0, step = 0;  // differences, so that what is constant stays as it is
  for (int k = 0; k < 4; ++k) {
    if (corners.weight[k] == 0) continue;
    const int x = point.left + k % 2, y = point.top + k / 2;
    if (!channels.window.contains(x, y)) return NAN;
    const double value = channels.at(c, x, y);
    if (k == 0) first = value;
    step += corners.weight[k] * (value - first);
  }
  return first + step;
}

constexpr int kDroppedBits = 15;  ///< of a float's 31 below the sign: steps of 1/256

}  // namespace

SharedPoints find_shared_points(const Geometry& before, const Geometry& now,
                                const Plane<glm::vec2>& motion,
                                const std::function<bool(int x, int y)>& counts) {
  const Search search(before, now);
  struct Row {
    std::vector<SharedPoint> points;
    std::vector<bool> moved;
  };
  std::vector<Row> rows(std::size_t(now.surfaces.height));
  for_each_row(now.surfaces.height, [&](int y) {
    Row& row = rows[std::size_t(y)];
    for (int x = 0; x < now.surfaces.width; ++x) {
      const int in_display_x = now.window.x0 + x, in_display_y = now.window.y0 + y;
      if (!now.display.contains(in_display_x, in_display_y) || !counts(in_display_x, in_display_y))
        continue;
      search.find(x, y, motion.empty() ? nullptr : &motion(x, y), row.points, row.moved);
    }
  });
  std::size_t all = 0, moved = 0;
  for (const Row& row : rows) {
    all += row.moved.size();
    moved += std::size_t(std::count(row.moved.begin(), row.moved.end(), true));
  }
  SharedPoints shared;
  shared.motion_is_wrong = moved > all / 2;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.points.size(); ++i)
      if (shared.motion_is_wrong || !row.moved[i]) shared.points.push_back(row.points[i]);
  }
  return shared;
}

void Changes::add(double change) {
  const auto size = float(std::abs(change));
  if (of_size_.empty()) of_size_.resize(std::size_t(1) << (31 - kDroppedBits));
  ++of_size_[std::bit_cast<std::uint32_t>(size) >> kDroppedBits];
  squares_ += change * change;
  ++count_;
}

void Changes::add(const Changes& more) {
  if (of_size_.empty()) of_size_.resize(more.of_size_.size());
  for (std::size_t i = 0; i < more.of_size_.size(); ++i) of_size_[i] += more.of_size_[i];
  squares_ += more.squares_;
  count_ += more.count_;
}

double Changes::rms() const { return std::sqrt(squares_ / double(count_)); }

double Changes::p99() const {
  const auto wanted = std::size_t(std::ceil(0.99 * double(count_)));
  std::size_t below = 0;
  for (std::size_t i = 0; i < of_size_.size(); ++i) {
    below += of_size_[i];
    if (below < wanted || below == 0) continue;
    return i == 0 ? 0 : std::bit_cast<float>(std::uint32_t(((i + 1) << kDroppedBits) - 1));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

FlickerFigures Flicker::figures() const {
  return {points, all.rms(), all.p99(), border.rms(), sum / double(all.count())};
}

void Flicker::add(const Flicker& more) {
  points += more.points;
  all.add(more.all);
  border.add(more.border);
  sum += more.sum;
}

Flicker measure_flicker(const SharedPoints& shared, const Channels& before, const Channels& now) {
  Flicker flicker;
  const std::size_t channels = std::min(before.planes.size(), now.planes.size());
  std::vector<double> values(channels), changes(channels);
  for (const SharedPoint& point : shared.points) {
    if (!now.window.contains(point.x, point.y)) continue;
    bool finite = true;
    for (std::size_t c = 0; c < channels && finite; ++c) {
      values[c] = now.at(c, point.x, point.y);
      changes[c] = values[c] - sample(before, c, point);
      finite = std::isfinite(changes[c]);
    }
    if (!finite) continue;
    ++flicker.points;
    for (std::size_t c = 0; c < channels; ++c) {
      flicker.sum += values[c];
      flicker.all.add(changes[c]);
      if (point.at_border) flicker.border.add(changes[c]);
    }
  }
  return flicker;
}

Channels subtract(const Channels& a, const Channels& b) {
  Channels out;
  out.window = intersection(a.window, b.window);
  out.planes.resize(std::max(a.planes.size(), b.planes.size()));
  for (std::size_t c = 0; c < out.planes.size(); ++c) {
    out.planes[c] = Plane<float>(out.window.width(), out.window.height());
    for (int y = out.window.y0; y < out.window.y1; ++y)
      for (int x = out.window.x0; x < out.window.x1; ++x)
        out.planes[c](x - out.window.x0, y - out.window.y0) = a.at(c, x, y) - b.at(c, x, y);
  }
  return out;
}

}  // namespace ssdo
