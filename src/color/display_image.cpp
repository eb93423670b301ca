// SPDX-License-Identifier: Apache-2.0
#include "color/display_image.h"

#include "color/downsample.h"
#include "color/light_colors.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Calls visit(index in the image, index in the planes) for every pixel that both windows show.
template <class Visit>
void for_each_shown_pixel(const Window& display, const Window& data, const Visit& visit) {
  const Window shown = intersection(display, data);
  for (int y = shown.y0; y < shown.y1; ++y) {
    for (int x = shown.x0; x < shown.x1; ++x) {
      visit(
          std::size_t(y - display.y0) * std::size_t(display.width()) + std::size_t(x - display.x0),
          std::size_t(y - data.y0) * std::size_t(data.width()) + std::size_t(x - data.x0));
    }
  }
}

void apply_display(Plane<glm::vec3>& colors, const DisplayTransform& display) {
  for_each_row(colors.height, [&](int y) {
    display.apply({&colors(0, y), std::size_t(colors.width)});
  });
}

/// What the display transform is given of a product that is light, and where it is shown.
Composite colors_of(const Product& product, const Results& results, bool straight) {
  if (const auto* plane = std::get_if<Plane<glm::vec3> Products::*>(&product.plane))
    return {product_at_output_size(product, results.shown().*(*plane), results),
            at_output_size(coverage(results.scene, results.gbuffer), results.gbuffer)};
  if (product.name != kComposite) {
    const LitBy all{results.scene.light, results.shown().direct};
    return {composed_of_light(product, all, results),
            at_output_size(coverage(results.scene, results.gbuffer), results.gbuffer)};
  }
  Composite shown = composite(results);
  for (std::size_t i = 0; i < shown.color.size() && straight; ++i) {
    if (shown.alpha[i] > 0) shown.color[i] /= shown.alpha[i];
  }
  return shown;
}

}  // namespace

bool needs_display(const std::string& product) {
  return find_product(product).kind == ProductKind::light;
}

DisplayImage make_display_image(const std::string& name, const Results& results,
                                const DisplayFormat& format) {
  const Downsampling& downsampling = results.gbuffer.downsampling;
  const Window display = downsampling.small(results.scene.geometry.display),
               data = downsampling.small(results.scene.geometry.window);
  const Product& product = find_product(name);
  const bool has_alpha = product.channels == "RGBA";
  DisplayImage image;
  image.width = display.width();
  image.height = display.height();
  image.pixel_aspect = results.gbuffer.pixel_aspect;
  image.channels = has_alpha && !format.alpha ? 3 : int(product.channels.size());
  const auto channels = std::size_t(image.channels);
  image.values.assign(display.area() * channels, 0.0f);
  if (product.kind != ProductKind::light) {
    // Data as they are; directions as colours usually show them, -1..1 in 0..1.
    const bool is_signed = product.kind == ProductKind::direction;
    const float scale = is_signed ? 0.5f : 1.0f, offset = is_signed ? 0.5f : 0.0f;
    const NamedChannels planes = product_channels(name, results);
    for_each_shown_pixel(display, data, [&](std::size_t to, std::size_t from) {
      for (std::size_t c = 0; c < channels; ++c)
        image.values[to * channels + c] = scale * planes.channels[c].pixels[from] + offset;
    });
    return image;
  }
  Composite shown = colors_of(product, results, format.alpha);
  if (has_alpha && !format.alpha) {
    glm::vec3 black(0);  // which some views lift
    format.transform->apply({&black, 1});
    for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = black[int(i % 3)];
  }
  apply_display(shown.color, *format.transform);
  for_each_shown_pixel(display, data, [&](std::size_t to, std::size_t from) {
    if (!has_alpha && shown.alpha[from] <= 0) return;
    for (int c = 0; c < 3; ++c) image.values[to * channels + std::size_t(c)] = shown.color[from][c];
    if (channels == 4) image.values[to * 4 + 3] = shown.alpha[from];
  });
  return image;
}

}  // namespace ssdo
