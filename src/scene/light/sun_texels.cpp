// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sun_texels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>

#include "math/frame.h"
#include "math/pi.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr glm::ivec2 kMostCells{256, 128};  ///< of the shape of a source

/// A texel of a source: its direction, what it adds to the irradiance, and whether it is as bright
/// as the source.
struct Lit {
  glm::vec3 direction;
  float light;
  bool surely;
};

/// Fills in size and radius of a source whose direction is known.
void set_extent(const std::vector<Lit>& texels, double light, float texel_angle,
                DistantSource& sun) {
  const glm::mat3 frame = frame_about(sun.direction);
  double xx = 0, yy = 0, xy = 0;
  float farthest = 0;
  for (const Lit& texel : texels) {
    const float angle =
        2 * std::asin(std::min(1.0f, glm::distance(texel.direction, sun.direction) / 2));
    const glm::vec3 local = texel.direction * frame;
    const float off = std::hypot(local.x, local.y);
    // As far from the middle as on the sphere: moments of angles.
    const glm::dvec2 at = off > 0 ? angle / off * glm::vec2(local) : glm::vec2(0);
    const double weight = double(texel.light) / light;
    xx += weight * at.x * at.x, yy += weight * at.y * at.y, xy += weight * at.x * at.y;
    if (texel.surely) farthest = std::max(farthest, angle);
  }
  // The sides of an even rectangle are sqrt(12) times the roots of its principal moments; a texel
  // is one too.
  const double half = (xx + yy) / 2, apart = std::hypot((xx - yy) / 2, xy);
  const double least = double(texel_angle) * double(texel_angle);
  sun.extent = glm::vec2(float(std::sqrt(12 * (half + apart) + least)),
                         float(std::sqrt(12 * std::max(0.0, half - apart) + least)));
  // Over a disc the mean square is half the radius squared: more exact than a few texels are.
  sun.angular_radius = std::max({texel_angle / 2, float(std::sqrt(2 * (xx + yy))), farthest});
}

}  // namespace

SunTexels::SunTexels(const Environment& whole) : whole_(whole), rest_(whole.map()) {
  for (int x = 0; x < width(); ++x) {
    const float azimuth = whole.azimuth_at(float(x) + 0.5f);
    horizon_.push_back(whole.axes() * glm::vec3(std::cos(azimuth), std::sin(azimuth), 0));
  }
  for (int y = 0; y < height(); ++y) {
    const float polar = kPif * (float(y) + 0.5f) / float(height());
    polar_.emplace_back(std::sin(polar), std::cos(polar));
  }
}

template <class Visit>
void SunTexels::for_each_texel(const std::vector<Window>& windows, const Surroundings& around,
                               const Visit& visit) const {
  const glm::vec3 pole = whole_.axes()[2];
  for (std::size_t w = 0; w < windows.size(); ++w) {
    for (int y = windows[w].y0; y < windows[w].y1; ++y) {
      const glm::vec2 polar = polar_[std::size_t(y)];
      for (int x = windows[w].x0; x < windows[w].x1; ++x) {
        const glm::vec3 d = polar.x * horizon_[std::size_t(x)] + polar.y * pole;
        const glm::vec3 sky = around(d) / whole_.gain();
        visit(w, x, y, d, glm::min((*rest_)(x, y), sky));
      }
    }
  }
}

/// The smallest window with all of `windows`, from the column after the widest gap on. It may pass
/// the date line.
Window SunTexels::bounds(const std::vector<Window>& windows) const {
  std::vector<bool> used(std::size_t(width()), false);
  int top = height(), bottom = 0;
  for (const Window& w : windows) {
    top = std::min(top, w.y0), bottom = std::max(bottom, w.y1);
    for (int x = w.x0; x < w.x1; ++x) used[std::size_t(x)] = true;
  }
  int widest = 0, start = 0, gap = 0;
  for (int x = 0; x < 2 * width(); ++x) {
    if (!used[std::size_t(x % width())]) {
      ++gap;
      continue;
    }
    if (gap > widest) widest = gap, start = x % width();
    gap = 0;
  }
  return {start, top, start + width() - widest, bottom};
}

std::optional<DistantSource> SunTexels::measure(const std::vector<Window>& windows, float threshold,
                                                const Surroundings& around) const {
  const Window all = bounds(windows);
  // Texels in a cell of the shape.
  const int across = (all.width() + kMostCells.x - 1) / kMostCells.x,
            down = (all.height() + kMostCells.y - 1) / kMostCells.y;
  Plane<float> cells((all.width() + across - 1) / across, (all.height() + down - 1) / down, 0.0f);
  std::vector<Lit> texels;
  glm::dvec3 power(0), sum(0);
  double light = 0;
  for_each_texel(windows, around,
                 [&](std::size_t, int x, int y, const glm::vec3& d, const glm::vec3& sky) {
                   const glm::vec3 part = whole_.texel_solid_angle(y) * ((*rest_)(x, y) - sky);
                   const float bright = brightness(part);
                   const int column = (x - all.x0 + width()) % width();
                   cells(column / across, (y - all.y0) / down) += bright;
                   power += glm::dvec3(part), light += double(bright);
                   sum += glm::dvec3(bright * d);
                   const float radiance = whole_.gain() * brightness((*rest_)(x, y));
                   texels.push_back({d, bright, radiance >= threshold});
                 });
  if (!(light > 0)) return std::nullopt;
  DistantSource sun;
  const double length = glm::length(sum);
  sun.direction = glm::vec3(sum / length);
  sun.irradiance = whole_.gain() / kPif * glm::vec3(power * (length / light));
  const float row = kPif / float(height()), column = 2 * kPif / float(width());
  sun.shape = SunShape({.axes = whole_.axes(),
                        .polar = row * float(all.y0),
                        .row_angle = row * float(down),
                        .azimuth = whole_.azimuth_at(float(all.x0)),
                        .column_angle = -column * float(across)},
                       cells);
  set_extent(texels, light, row, sun);
  set_points(sun);
  return sun;
}

std::vector<glm::vec3> SunTexels::remove(const std::vector<Window>& windows,
                                         const Surroundings& around, float part) {
  if (!copy_) {
    copy_ = std::make_shared<Plane<glm::vec3>>(Plane<glm::vec3>::like(*rest_));
    for_each_row(height(), [&](int y) { std::copy_n(&(*rest_)(0, y), width(), &(*copy_)(0, y)); });
    rest_ = copy_;
  }
  std::vector<glm::vec3> lost(windows.size(), glm::vec3(0));
  for_each_texel(windows, around,
                 [&](std::size_t window, int x, int y, const glm::vec3&, const glm::vec3& sky) {
                   const glm::vec3 excess = (*copy_)(x, y) - sky;
                   (*copy_)(x, y) = part < 1 ? (*copy_)(x, y) - part * excess : sky;
                   lost[window] += whole_.gain() * whole_.texel_solid_angle(y) * excess;
                 });
  return lost;
}

}  // namespace ssdo
