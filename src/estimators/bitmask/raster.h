// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <limits>

#include "estimators/bitmask/march_scene.h"
#include "estimators/bitmask/slice_pattern.h"
#include "math/light_range.h"
#include "math/plane.h"
#include "parallel/tiles.h"
#include "simd/interleaved.h"

namespace ssdo {

/// Planes of a picture in the order of the march, and back.
class Raster {
 public:
  explicit Raster(const MarchScene& scene) : scene_(scene), layout_(scene.layout) {}

  const Interleaving& layout() const { return layout_; }

  /// One colour for each pixel, not initialised.
  InterleavedVectors make_color() const {
    return {InterleavedPlane(layout_), InterleavedPlane(layout_), InterleavedPlane(layout_)};
  }

  InterleavedVectors black() const {
    InterleavedVectors color = make_color();
    for_each_row(layout_.height(), [&](int y) {
      for (InterleavedPlane& plane : color) plane.fill_row(layout_, y, 0);
    });
    return color;
  }

  /// A value of every pixel of the raster, clamped to the range of light.
  InterleavedVectors interleaved(const Plane<glm::vec3>& picture) const {
    InterleavedVectors color = black();
    for_each_row(layout_.height(), [&](int y) {
      for_each_pixel(y, [&](std::size_t pixel, std::ptrdiff_t i) {
        const glm::vec3 value = within_range(picture[pixel]);
        for (int c = 0; c < 3; ++c) color[std::size_t(c)][i] = value[c];
      });
    });
    return color;
  }

  /// A value of every pixel of the raster.
  InterleavedPlane interleaved(const Plane<float>& picture) const {
    InterleavedPlane plane(layout_);
    for_each_row(layout_.height(), [&](int y) {
      plane.fill_row(layout_, y, 0);
      for_each_pixel(y, [&](std::size_t pixel, std::ptrdiff_t i) { plane[i] = picture[pixel]; });
    });
    return plane;
  }

  /// Calls `work(pixel, index)` for each pixel of a row of the raster; index is that of the march.
  template <class Work>
  void for_each_pixel(int y, const Work& work) const {
    for (int first = 0; first < std::min(kPeriod, layout_.width()); ++first) {
      std::ptrdiff_t i = layout_.index(first, y);
      const std::size_t row = std::size_t(y) * std::size_t(layout_.width());
      for (int x = first; x < layout_.width(); x += kPeriod) work(row + std::size_t(x), i++);
    }
  }

  /// `value(index)` of every receiver; `background` where there is no surface.
  template <class T, class Value>
  Plane<T> of_receivers(const T& background, const Value& value) const {
    const Window& to = scene_.receivers;
    auto out = Plane<T>::unset(to.width(), to.height());
    for_each_row(to.height(), [&](int y) {
      for (int first = 0; first < std::min(kPeriod, to.width()); ++first) {
        std::ptrdiff_t i = layout_.index(to.x0 + first, to.y0 + y);
        for (int x = first; x < to.width(); x += kPeriod, ++i)
          out(x, y) = scene_.receives(i) ? value(i) : background;
      }
    });
    return out;
  }

  /// The values of an overview in the order of `far`, each mapped by `changed`; not-a-number beside
  /// the overview.
  template <class Change = std::identity>
  InterleavedPlane in_whole_rows(const InterleavedPlane& values, const OverviewRaster& far,
                                 const Change& changed = {}) const {
    InterleavedPlane out(far.layout);
    std::fill_n(out.data(), far.layout.size(), std::numeric_limits<float>::quiet_NaN());
    for_each_row(far.height, [&](int y) {
      for (int x = 0; x < far.width; ++x)
        out[far.index(x, y)] = changed(values[layout_.index(x, y)]);
    });
    return out;
  }
  /// The planes of an overview in whole rows.
  MarchPlanes in_whole_rows(const MarchPlanes& from, const OverviewRaster& far) const {
    MarchPlanes planes;
    for (const MarchLayer& layer : from.layers)
      planes.layers.push_back(
          {in_whole_rows(layer.depth, far), in_whole_rows(layer.thickness, far)});
    planes.tilt = in_whole_rows(from.tilt, far, [](float both) {
      constexpr float kPixels = 1.0f / kPeriod;  // steps are in pixels of the frame
      return pack_bf16x2(kPixels * unpack_bf16_first(both), kPixels * unpack_bf16_second(both));
    });
    planes.tilt_rest = in_whole_rows(from.tilt_rest, far);  // a power of two changes no more
    return planes;
  }
  InterleavedVectors in_whole_rows(const InterleavedVectors& values,
                                   const OverviewRaster& far) const {
    return {in_whole_rows(values[0], far), in_whole_rows(values[1], far),
            in_whole_rows(values[2], far)};
  }

  /// A picture from a plane that is not needed any more.
  Plane<float> picture(InterleavedPlane plane, float background = 0) const {
    return of_receivers(background, [&](std::ptrdiff_t i) { return plane[i]; });
  }

  /// A picture of `unit` times the shares of a plane.
  Plane<float> picture(InterleavedRatios plane, float unit) const {
    return of_receivers(0.0f, [&](std::ptrdiff_t i) { return unit * plane[i]; });
  }

  /// A picture of `base` plus the shares of each channel.
  Plane<glm::vec3> picture(InterleavedColorRatios color, const InterleavedPlane& base) const {
    return of_receivers(glm::vec3(0), [&](std::ptrdiff_t i) {
      return base[i] + glm::vec3(color[0][i], color[1][i], color[2][i]);
    });
  }

  template <class T>
  Plane<glm::vec3> picture(std::array<InterleavedValues<T>, 3> color) const {
    return of_receivers(glm::vec3(0), [&](std::ptrdiff_t i) {
      return glm::vec3(color[0][i], color[1][i], color[2][i]);
    });
  }

 private:
  static constexpr int kPeriod = Interleaving::kPeriod;

  const MarchScene& scene_;
  const Interleaving& layout_;
};

}  // namespace ssdo
