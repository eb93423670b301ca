// SPDX-License-Identifier: Apache-2.0
#include "io/exr/pixel_filter.h"

#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "parallel/tiles.h"

namespace ssdo::test::pixel_filter_test {
namespace {

/// Overscan of odd widths around a display window.
const Window kDisplay{0, 0, 24, 16}, kData{-5, -3, 27, 20};

/// The filter of Cycles at a distance in pixels of the small picture, 0 beyond 1.5.
double blackman_harris(double distance) {
  const double t = 2 * 3.14159265358979 * (distance / 3 + 0.5);
  if (std::abs(distance) > 1.5) return 0;
  return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
}

Plane<float> noise(const Window& window) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> value(-1, 3);
  Plane<float> plane(window.width(), window.height());
  for (float& v : plane.pixels) v = value(random);
  return plane;
}

template <class T>
StoredChannel stored(Imf::PixelType type, const Plane<T>& values) {
  StoredChannel channel{{"x", type}, std::vector<std::byte>(values.size() * sizeof(T))};
  std::memcpy(channel.pixels.data(), values.pixels.data(), channel.pixels.size());
  return channel;
}

template <class T>
std::vector<T> values_of(const StoredChannel& channel) {
  std::vector<T> values(channel.pixels.size() / sizeof(T));
  std::memcpy(values.data(), channel.pixels.data(), channel.pixels.size());
  return values;
}

class PixelFilter : public testing::TestWithParam<int> {
 protected:
  const Downsampling d_{GetParam(), kDisplay};
};
INSTANTIATE_TEST_SUITE_P(Factors, PixelFilter, testing::Values(2, 4, 8));

TEST_P(PixelFilter, AConstantStaysWhatItIsUpToTheBorder) {
  const Plane<float> out =
      filter_pixels(Plane<float>(kData.width(), kData.height(), 0.7f), kData, d_);
  const Window small = d_.small(kData);
  ASSERT_EQ(out.width, small.width());
  ASSERT_EQ(out.height, small.height());
  for (const float value : out.pixels) EXPECT_NEAR(value, 0.7f, 1e-6);
}

/// An edge that covers all that is right of a column: its pixels are sums of the filter's weights.
TEST_P(PixelFilter, AnEdgeHasTheWeightsOfTheFilter) {
  const int n = GetParam();
  for (int edge = 8; edge < 8 + n; ++edge) {
    Plane<float> step(kDisplay.width(), kDisplay.height());
    for (int y = 0; y < step.height; ++y)
      for (int x = edge; x < step.width; ++x) step(x, y) = 1;
    const Plane<float> out = filter_pixels(step, kDisplay, d_);
    for (int x = 1; x < out.width - 1; ++x) {
      double covered = 0, all = 0;
      for (int i = 0; i < step.width; ++i) {
        const double weight = blackman_harris((i + 0.5) / n - (x + 0.5));
        all += weight;
        covered += i >= edge ? weight : 0;
      }
      EXPECT_NEAR(out(x, out.height / 2), covered / all, 1e-5) << "edge " << edge << " at " << x;
    }
  }
}

TEST_P(PixelFilter, RowsAndColumnsAreFilteredAlike) {
  const Window square{0, 0, 16, 16};
  const Downsampling d{GetParam(), square};
  const Plane<float> plane = noise(square);
  Plane<float> turned(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) turned(y, x) = plane(x, y);
  const Plane<float> a = filter_pixels(plane, square, d), b = filter_pixels(turned, square, d);
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) EXPECT_NEAR(a(x, y), b(y, x), 1e-5);
}

/// A pixel of the display window is the same with and without overscan that is out of reach.
TEST_P(PixelFilter, PixelsDependOnTheirReachAlone) {
  const Plane<float> plane = noise(kData), all = filter_pixels(plane, kData, d_);
  const Window small = d_.small(kData), display = d_.small(kDisplay);
  Plane<float> changed = plane;
  const Window seen{-d_.reach(), -d_.reach(), kDisplay.x1 + d_.reach(), kDisplay.y1 + d_.reach()};
  for (int y = kData.y0; y < kData.y1; ++y) {
    for (int x = kData.x0; x < kData.x1; ++x)
      if (!seen.contains(x, y)) changed(x - kData.x0, y - kData.y0) = 1e6f;
  }
  const Plane<float> other = filter_pixels(changed, kData, d_);
  for (int y = display.y0; y < display.y1; ++y) {
    for (int x = display.x0; x < display.x1; ++x)
      EXPECT_EQ(all(x - small.x0, y - small.y0), other(x - small.x0, y - small.y0));
  }
}

TEST_P(PixelFilter, SameBitsForAnyNumberOfThreads) {
  const Plane<float> plane = noise(kData);
  std::vector<Plane<float>> found;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    found.push_back(filter_pixels(plane, kData, d_));
  }
  EXPECT_EQ(found[0].pixels, found[1].pixels);
}

TEST_P(PixelFilter, IdsStayIds) {
  const int n = GetParam();
  Plane<unsigned> ids(kData.width(), kData.height());
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = 0xfffffff0u - unsigned(i);
  const auto found = values_of<unsigned>(filter_stored(stored(Imf::UINT, ids), kData, d_, false));
  const Window small = d_.small(kData);
  ASSERT_EQ(found.size(), small.area());
  // Inside, each is that of the pixel next to the middle.
  for (int y = 0; y < kDisplay.height() / n; ++y) {
    for (int x = 0; x < kDisplay.width() / n; ++x) {
      EXPECT_EQ(
          found[std::size_t(y - small.y0) * std::size_t(small.width()) + std::size_t(x - small.x0)],
          ids(x * n + n / 2 - kData.x0, y * n + n / 2 - kData.y0));
    }
  }
}

TEST_P(PixelFilter, StoredChannelsKeepTheirType) {
  const Plane<float> plane = noise(kData), small = filter_pixels(plane, kData, d_);
  Plane<half> halves(plane.width, plane.height);
  for (std::size_t i = 0; i < plane.size(); ++i) halves[i] = half(plane[i]);
  const StoredChannel as_half = filter_stored(stored(Imf::HALF, halves), kData, d_, false),
                      as_float = filter_stored(stored(Imf::FLOAT, plane), kData, d_, false);
  EXPECT_EQ(as_half.channel.type, Imf::HALF);
  const auto found = values_of<half>(as_half);
  ASSERT_EQ(found.size(), small.size());
  for (std::size_t i = 0; i < small.size(); ++i) EXPECT_NEAR(found[i], small[i], 2e-3);
  const auto floats = values_of<float>(as_float);
  EXPECT_TRUE(std::equal(floats.begin(), floats.end(), small.pixels.begin(), small.pixels.end()));
  std::set<float> known(plane.pixels.begin(), plane.pixels.end());
  for (const float v : values_of<float>(filter_stored(stored(Imf::FLOAT, plane), kData, d_, true)))
    EXPECT_TRUE(known.contains(v));
}

TEST(PixelFilterByOne, KeepsEveryBit) {
  const Plane<float> plane = noise(kData);
  EXPECT_EQ(filter_pixels(plane, kData, {1, kDisplay}).pixels, plane.pixels);
}

}  // namespace
}  // namespace ssdo::test::pixel_filter_test
