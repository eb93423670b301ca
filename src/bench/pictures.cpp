// SPDX-License-Identifier: Apache-2.0
#include "bench/pictures.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "color/display_image.h"
#include "io/images/image_file.h"
#include "math/luminance.h"

namespace ssdo {
namespace {

/// Largest width and height of a picture in a page.
constexpr int kMostPixels = 720;

/// Grey levels of a map of errors. Noise does not compress: with 256 the page is twice as large.
constexpr float kLevels = 64;

DisplayImage thinned(const DisplayImage& image) {
  const int step = (std::max(image.width, image.height) + kMostPixels - 1) / kMostPixels;
  DisplayImage out{(image.width + step - 1) / step,
                   (image.height + step - 1) / step,
                   image.channels,
                   image.pixel_aspect,
                   {}};
  for (int y = 0; y < image.height; y += step) {
    for (int x = 0; x < image.width; x += step) {
      const auto from =
          image.values.begin() + std::ptrdiff_t(y * std::size_t(image.width) + x) * image.channels;
      out.values.insert(out.values.end(), from, from + image.channels);
    }
  }
  return out;
}

/// The channels as colours over a frame's window, a single channel as grey; 0 outside their own
/// window.
Plane<glm::vec3> colors_over(const Window& window, const Channels& from) {
  Plane<glm::vec3> out(window.width(), window.height(), glm::vec3(0));
  for (int y = window.y0; y < window.y1; ++y) {
    for (int x = window.x0; x < window.x1; ++x) {
      if (!from.window.contains(x, y)) continue;
      for (int c = 0; c < 3; ++c) {
        const auto& plane = from.planes[from.planes.size() == 3 ? std::size_t(c) : 0];
        out(x - window.x0, y - window.y0)[c] = plane(x - from.window.x0, y - from.window.y0);
      }
    }
  }
  return out;
}

}  // namespace

BenchPictures::BenchPictures(const Frame& frame, const ColorOptions& color)
    : frame_(frame), display_(color, color_tags(frame)) {}

std::string BenchPictures::picture_of(const std::string& product, const Channels& channels) const {
  const Geometry& g = frame_.scene.geometry;
  Plane<glm::vec3> colors = colors_over(g.window, channels);
  const Product& shown = find_product(product);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    if (!g.is_surface(i)) colors[i] = glm::vec3(shown.background);
  }
  Products products;
  if (const auto* plane = std::get_if<Plane<glm::vec3> Products::*>(&shown.plane)) {
    products.*(*plane) = std::move(colors);
  } else if (const auto* grey = std::get_if<Plane<float> Products::*>(&shown.plane)) {
    products.*(*grey) = Plane<float>(g.window.width(), g.window.height());
    for (std::size_t i = 0; i < colors.size(); ++i) (products.*(*grey))[i] = luminance(colors[i]);
  }
  return encode(product, products);
}

std::string BenchPictures::map_of(const ChannelsDifference& difference, double scale) const {
  const Window& window = frame_.scene.geometry.window;
  const Plane<glm::vec3> colors = colors_over(window, {window, difference.a_minus_b});
  Products products;
  products.ao = Plane<float>(window.width(), window.height());
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const float share = std::clamp(luminance(colors[i]) / float(scale), -1.0f, 1.0f);
    products.ao[i] = 0.5f + 0.5f * std::round(share * (kLevels / 2)) / (kLevels / 2);
  }
  return encode("ao", products);
}

std::string BenchPictures::encode(const std::string& product, const Products& products) const {
  const DisplayImage image =
      thinned(make_display_image(product, {frame_.scene, frame_.gbuffer, products}, {&display_}));
  const auto bytes = encode_image("picture.png", image.spec(8), image.values);
  return {bytes.begin(), bytes.end()};
}

}  // namespace ssdo
