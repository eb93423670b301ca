// SPDX-License-Identifier: Apache-2.0
#include "io/exr/pixel_filter.h"

#include <OpenImageIO/filter.h>
#include <half.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// The pixels of a row or column that make one pixel of the small picture.
struct Taps {
  int first = 0;
  std::vector<float> weights;  ///< of `first` and those after it; their sum is 1
};

using PixelFilter = std::unique_ptr<OIIO::Filter1D, void (*)(OIIO::Filter1D*)>;

PixelFilter make_filter() {
  return {OIIO::Filter1D::create("blackman-harris", Downsampling::kFilterWidth),
          OIIO::Filter1D::destroy};
}

/// Taps of each pixel in [to, to_end), which cover `factor` pixels each from `origin` on, among
/// pixels [from, from_end).
struct Axis {
  int from, from_end;  ///< of the large picture
  int to, to_end;      ///< of the small one
  int origin;          ///< of the large one, where the pixel `to` begins
  int factor;

  int nearest(int pixel) const {
    return std::clamp(origin + (pixel - to) * factor + factor / 2, from, from_end - 1) - from;
  }

  std::vector<Taps> taps(int reach) const {
    const PixelFilter kernel = make_filter();
    std::vector<Taps> all;
    for (int pixel = to; pixel < to_end; ++pixel) {
      const int begin = origin + (pixel - to) * factor, first = std::max(begin - reach, from),
                last = std::min(begin + factor + reach, from_end);
      Taps& taps = all.emplace_back(Taps{first - from, {}});
      double sum = 0;
      for (int i = first; i < last; ++i) {
        const float distance = (float(i - begin) + 0.5f) / float(factor) - 0.5f;
        sum += double(taps.weights.emplace_back((*kernel)(distance)));
      }
      for (float& weight : taps.weights) weight = float(double(weight) / sum);
    }
    return all;
  }
};

Axis columns(const Window& from, const Downsampling& d) {
  const Window to = d.small(from);
  return {from.x0, from.x1, to.x0, to.x1, d.large(to).x0, d.factor};
}

Axis rows(const Window& from, const Downsampling& d) {
  const Window to = d.small(from);
  return {from.y0, from.y1, to.y0, to.y1, d.large(to).y0, d.factor};
}

template <class T>
Plane<T> filter(const Plane<T>& values, const Window& from, const Downsampling& d) {
  const std::vector<Taps> across = columns(from, d).taps(d.reach()),
                          down = rows(from, d).taps(d.reach());
  const int width = int(across.size()), height = int(down.size());
  Plane<T> narrow(width, values.height);
  for_each_row(values.height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const Taps& taps = across[std::size_t(x)];
      for (std::size_t k = 0; k < taps.weights.size(); ++k)
        narrow(x, y) += taps.weights[k] * values(taps.first + int(k), y);
    }
  });
  Plane<T> out(width, height);
  for_each_row(height, [&](int y) {
    const Taps& taps = down[std::size_t(y)];
    for (std::size_t k = 0; k < taps.weights.size(); ++k) {
      for (int x = 0; x < width; ++x) out(x, y) += taps.weights[k] * narrow(x, taps.first + int(k));
    }
  });
  return out;
}

/// The values of a channel as `T` stores them.
template <class T>
Plane<T> values_of(const StoredChannel& stored, const Window& window) {
  Plane<T> values(window.width(), window.height());
  std::memcpy(values.pixels.data(), stored.pixels.data(), stored.pixels.size());
  return values;
}

template <class T>
StoredChannel stored_as(const ExrChannel& channel, const Plane<T>& values) {
  StoredChannel stored{channel, std::vector<std::byte>(values.size() * sizeof(T))};
  std::memcpy(stored.pixels.data(), values.pixels.data(), stored.pixels.size());
  return stored;
}

template <class T>
StoredChannel nearest_stored(const StoredChannel& stored, const Window& from,
                             const Downsampling& d) {
  const Plane<T> values = values_of<T>(stored, from);
  const Axis across = columns(from, d), down = rows(from, d);
  Plane<T> out(across.to_end - across.to, down.to_end - down.to);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x)
      out(x, y) = values(across.nearest(across.to + x), down.nearest(down.to + y));
  }
  return stored_as(stored.channel, out);
}

template <class T>
StoredChannel filtered_stored(const StoredChannel& stored, const Window& from,
                              const Downsampling& d) {
  const Plane<T> values = values_of<T>(stored, from);
  auto large = Plane<float>::like(values);
  for (std::size_t i = 0; i < values.size(); ++i) large[i] = float(values[i]);
  const Plane<float> small = filter(large, from, d);
  auto out = Plane<T>::like(small);
  for (std::size_t i = 0; i < small.size(); ++i) out[i] = T(small[i]);
  return stored_as(stored.channel, out);
}

}  // namespace

Plane<float> filter_pixels(const Plane<float>& values, const Window& from,
                           const Downsampling& downsampling) {
  return downsampling.is_identity() ? values : filter(values, from, downsampling);
}

Plane<glm::vec3> filter_pixels(const Plane<glm::vec3>& values, const Window& from,
                               const Downsampling& downsampling) {
  return downsampling.is_identity() ? values : filter(values, from, downsampling);
}

StoredChannel filter_stored(const StoredChannel& stored, const Window& from,
                            const Downsampling& downsampling, bool nearest) {
  const Imf::PixelType type = stored.channel.type;
  if (type == Imf::UINT) return nearest_stored<unsigned>(stored, from, downsampling);
  if (type == Imf::HALF) {
    return nearest ? nearest_stored<unsigned short>(stored, from, downsampling)
                   : filtered_stored<half>(stored, from, downsampling);
  }
  return nearest ? nearest_stored<float>(stored, from, downsampling)
                 : filtered_stored<float>(stored, from, downsampling);
}

}  // namespace ssdo
