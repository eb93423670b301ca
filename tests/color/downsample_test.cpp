// SPDX-License-Identifier: Apache-2.0
//
// Products and composites of a G-buffer that is larger than the outputs.
#include "color/downsample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <random>

#include "color/display_image.h"
#include "io/exr/pixel_filter.h"
#include "support/scene_of.h"

namespace ssdo::test::downsample_test {
namespace {

/// Surfaces of random colours under random light, half of them with nothing behind, and overscan on
/// two sides.
class Downsample : public testing::TestWithParam<int> {
 protected:
  Downsample() : large_(display_.x1 + 3, display_.y1 + 2) {
    gbuffer_.window = {-3, -2, display_.x1, display_.y1};
    gbuffer_.display = display_;
    gbuffer_.downsampling = {GetParam(), display_};
    Geometry g;
    g.window = gbuffer_.window, g.display = display_;
    g.surfaces = Surfaces(large_.width, large_.height);
    for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
      const bool is_surface = int(i) % large_.width > large_.width / 3;
      if (!is_surface) continue;
      g.surfaces.set_position(i, {0, 0, -1}), g.surfaces.rounding[i] = 0;
      g.surfaces.set_normal(i, glm::normalize(random_vector() - 0.5f + glm::vec3(0, 0, 1)));
    }
    scene_ = scene_of(g, two_lights());
    gbuffer_.alpha = Plane<float>(large_.width, large_.height);
    for_each_plane(
        [&](const Product& product, auto& plane) {
          using Value = std::decay_t<decltype(plane[0])>;
          plane = Plane<Value>(large_.width, large_.height);
          for (std::size_t i = 0; i < plane.size(); ++i) {
            const glm::vec3 v = random_vector();
            if constexpr (std::is_same_v<Value, float>)
              plane[i] = is_surface(i) ? v.x : product.background;
            else
              plane[i] = is_surface(i) ? v : glm::vec3(product.background);
          }
        },
        products_);
    for (std::size_t i = 0; i < large_.size(); ++i) {
      gbuffer_.alpha[i] = is_surface(i) ? 0.2f + 0.8f * random_vector().x : 0;
      scene_.senders.albedo[i] = is_surface(i) ? random_vector() : glm::vec3(0);
      if (is_surface(i)) products_.direct[i] *= open(i);
      products_.bent[i] = is_surface(i) ? glm::normalize(products_.bent[i]) : glm::vec3(0);
    }
  }

  static Environment two_lights() {
    const auto map = std::make_shared<Plane<glm::vec3>>(64, 32);
    const Environment environment(map, {});
    for (int y = 0; y < map->height; ++y) {
      for (int x = 0; x < map->width; ++x) {
        const float side = environment.texel_direction(x, y).x;
        (*map)(x, y) = glm::vec3(0.5f + 0.4f * side, 0.5f, 0.5f - 0.4f * side);
      }
    }
    return environment;
  }

  glm::vec3 random_vector() {
    std::uniform_real_distribution<float> value(0.05f, 1);
    return {value(random_), value(random_), value(random_)};
  }

  bool is_surface(std::size_t i) const { return scene_.geometry.is_surface(i); }
  glm::vec3 open(std::size_t i) const {
    return scene_.light.unoccluded(scene_.geometry.surfaces[i].position,
                                   scene_.geometry.surfaces[i].normal);
  }
  Results results() const { return {scene_, gbuffer_, products_, composition_}; }

  /// What a renderer's filter makes of alpha albedo `light(pixel)`.
  Plane<glm::vec3> rendered(const std::function<glm::vec3(std::size_t)>& light) const {
    Plane<glm::vec3> colors(large_.width, large_.height);
    for (std::size_t i = 0; i < colors.size(); ++i) {
      if (is_surface(i)) colors[i] = gbuffer_.alpha[i] * (scene_.senders.albedo[i] * light(i));
    }
    return filter_pixels(colors, gbuffer_.window, gbuffer_.downsampling);
  }

  Plane<float> filtered_alpha() const {
    return filter_pixels(gbuffer_.alpha, gbuffer_.window, gbuffer_.downsampling);
  }

  static void expect_near(const Plane<glm::vec3>& found, const Plane<glm::vec3>& expected) {
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(found[i][c], expected[i][c], 2e-6) << "pixel " << i << " channel " << c;
    }
  }

  static constexpr Window display_{0, 0, 24, 16};
  std::mt19937 random_{3};
  Plane<float> large_;  ///< for its size
  Scene scene_;
  GBuffer gbuffer_;
  Products products_;
  Composition composition_;
};
INSTANTIATE_TEST_SUITE_P(Factors, Downsample, testing::Values(2, 4));

TEST_P(Downsample, RelightIsTheFilteredComposite) {
  const Composite found = composite(results());
  expect_near(found.color,
              rendered([&](std::size_t i) { return products_.direct[i] + products_.bounce[i]; }));
  EXPECT_EQ(found.alpha.pixels, filtered_alpha().pixels);
}

/// An ambient layer that was filtered as the composite is loses exactly what is hidden of it, and
/// what lamps gave stays.
TEST_P(Downsample, OccludeIsExactForAFilteredAmbientLayer) {
  const glm::vec3 lamp(2, 1, 0.5f);
  gbuffer_.ambient = rendered([&](std::size_t i) { return open(i); });
  gbuffer_.beauty = gbuffer_.ambient;
  for (glm::vec3& color : gbuffer_.beauty.pixels) color += lamp;
  composition_ = {Compose::occlude, false};
  Plane<glm::vec3> expected = rendered([&](std::size_t i) { return products_.direct[i]; });
  for (glm::vec3& color : expected.pixels) color += lamp;
  expect_near(composite(results()).color, expected);
}

TEST_P(Downsample, OccludeByAoIsExactForAFilteredAmbientLayer) {
  const glm::vec3 sky(0.5f, 1, 1.5f);
  gbuffer_.ambient = gbuffer_.beauty = rendered([&](std::size_t) { return sky; });
  composition_ = {Compose::occlude, true};
  expect_near(composite(results()).color,
              rendered([&](std::size_t i) { return products_.ao[i] * sky; }));
}

TEST_P(Downsample, OccludeTakesTheMeanReflectionFromTheSpecularLayer) {
  const Plane<float> alpha = filtered_alpha();
  gbuffer_.ambient = Plane<glm::vec3>(alpha.width, alpha.height);
  gbuffer_.specular = gbuffer_.ambient;
  for (std::size_t i = 0; i < alpha.size(); ++i) gbuffer_.specular[i] = glm::vec3(alpha[i]);
  gbuffer_.beauty = gbuffer_.specular;
  composition_ = {Compose::occlude, false};
  Plane<glm::vec3> reflected(large_.width, large_.height);
  for (std::size_t i = 0; i < reflected.size(); ++i)
    reflected[i] = glm::vec3(gbuffer_.alpha[i] * products_.reflection[i]);
  expect_near(composite(results()).color,
              filter_pixels(reflected, gbuffer_.window, gbuffer_.downsampling));
}

TEST_P(Downsample, AddPutsTheFilteredLightOnTheBeauty) {
  const glm::vec3 lamp(2, 1, 0.5f);
  const Plane<float> alpha = filtered_alpha();
  gbuffer_.beauty = Plane<glm::vec3>(alpha.width, alpha.height, lamp);
  composition_ = {Compose::add, false};
  Plane<glm::vec3> expected =
      rendered([&](std::size_t i) { return products_.direct[i] + products_.bounce[i]; });
  for (glm::vec3& color : expected.pixels) color += lamp;
  expect_near(composite(results()).color, expected);
}

/// So that a compositor may put the layers together: filtered albedo times light is the composite.
TEST_P(Downsample, LightTimesFilteredAlbedoIsWhatSurfacesSend) {
  const Plane<glm::vec3> direct =
      product_at_output_size(find_product("direct"), products_.direct, results());
  Plane<glm::vec3> sent = rendered([](std::size_t) { return glm::vec3(1); });
  for (std::size_t i = 0; i < sent.size(); ++i) sent[i] *= direct[i];
  expect_near(sent, rendered([&](std::size_t i) { return products_.direct[i]; }));
}

TEST_P(Downsample, BlackSurfacesHaveLight) {
  scene_.senders.albedo = Plane<HalfColor>(large_.width, large_.height, glm::vec3(0));
  for (glm::vec3& light : products_.direct.pixels) light = glm::vec3(0.75f);
  const Plane<glm::vec3> found =
      product_at_output_size(find_product("direct"), products_.direct, results());
  EXPECT_NEAR(found[found.size() - 1].x, 0.75f, 1e-5);
}

TEST_P(Downsample, DataAreMeansOverSurfacesAlone) {
  for (std::size_t i = 0; i < large_.size(); ++i) products_.ao[i] = is_surface(i) ? 0.25f : 1;
  const Plane<float> ao = product_at_output_size(find_product("ao"), products_.ao, results()),
                     alpha = filtered_alpha();
  int edges = 0;
  for (std::size_t i = 0; i < ao.size(); ++i) {
    EXPECT_NEAR(ao[i], alpha[i] > 0 ? 0.25f : 1.0f, 1e-6);
    edges += alpha[i] > 0 && alpha[i] < 0.1f;
  }
  EXPECT_GT(edges, 0);
}

TEST_P(Downsample, ASurfaceCountsByItsCoverage) {
  const Plane<float> found = product_at_output_size(find_product("guessed"), products_.guessed,
                                                    results()),
                     alpha = filtered_alpha();
  Plane<float> weighted(large_.width, large_.height);
  for (std::size_t i = 0; i < weighted.size(); ++i)
    weighted[i] = gbuffer_.alpha[i] * products_.guessed[i];
  weighted = filter_pixels(weighted, gbuffer_.window, gbuffer_.downsampling);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i] * alpha[i], weighted[i], 1e-6);
}

TEST_P(Downsample, DirectionsHaveLengthOne) {
  const Plane<glm::vec3> bent =
      product_at_output_size(find_product("bent"), products_.bent, results());
  const Plane<float> alpha = filtered_alpha();
  for (std::size_t i = 0; i < bent.size(); ++i)
    EXPECT_NEAR(glm::length(bent[i]), alpha[i] > 0 ? 1 : 0, 1e-6);
}

TEST_P(Downsample, PicturesHaveTheSizeOfTheOutputs) {
  const DisplayImage ao = make_display_image("ao", results(), {});
  EXPECT_EQ(ao.width, display_.width() / GetParam());
  EXPECT_EQ(ao.height, display_.height() / GetParam());
  const Plane<float> plane = product_at_output_size(find_product("ao"), products_.ao, results());
  const Window data = gbuffer_.downsampling.small(gbuffer_.window);
  EXPECT_EQ(ao.values[1], plane(1 - data.x0, -data.y0));
}

}  // namespace
}  // namespace ssdo::test::downsample_test
