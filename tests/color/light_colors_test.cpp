// SPDX-License-Identifier: Apache-2.0
//
// What is made of the light of lamps: shadow and unshadowed, and the composite of a beauty whose
// lamps cast shadows.
#include "color/light_colors.h"

#include <gmock/gmock.h>

#include "color/compose.h"
#include "color/display_image.h"
#include "scene/light/light_group.h"
#include "scene/light/painted_map.h"
#include "support/point_source.h"
#include "support/scene_of.h"

namespace ssdo::test::light_colors_test {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;

/// Two pixels, of which the second shows no surface, lit by a map and two lamps.
class LightColors : public testing::Test {
 protected:
  LightColors() {
    Geometry g;
    g.window = g.display = {0, 0, 2, 1};
    g.surfaces = Surfaces(2, 1);
    g.surfaces.set(0, {{0, 0, -1}, {0, 0, 1}, 0});
    scene_ = scene_of(g, paint(64, [](const glm::vec3& d) {
                        return glm::vec3(1 + 0.5f * d.z, 1, 1 - 0.5f * d.x);
                      }));
    EXPECT_TRUE(scene_.light.sources.empty()) << "a sky alone";
    // Half a unit above the surface: 4 times what they give at a distance of 1.
    add_lamp("key", {1, 0.5f, 0.25f});
    add_lamp("fill", {0.25f, 0.25f, 0});
    lights_ = light_groups_of(scene_.light);
    const glm::vec3 shares[] = {{0.5f, 0.25f, 0.75f}, glm::vec3(0.25f), glm::vec3(0)};
    products_.direct = Plane<glm::vec3>(2, 1, glm::vec3(0));
    for (std::size_t k = 0; k < 3; ++k) {
      LightProducts& light = products_.lights.emplace_back();
      light.name = lights_[k].name;
      light.direct = Plane<glm::vec3>(2, 1, glm::vec3(0));
      const Surfel& s = scene_.geometry.surfaces[0];
      light.direct[0] = shares[k] * lights_[k].light.unoccluded(s.position, s.normal);
      products_.direct[0] += light.direct[0];
    }
    products_.ao = Plane<float>(2, 1, 0.125f);
    gbuffer_.beauty = Plane<glm::vec3>(2, 1, glm::vec3(3, 2, 1));
  }

  void add_lamp(const std::string& name, const glm::vec3& light) {
    auto lamp = std::make_shared<PointSource>(glm::vec3(0, 0, -0.5f), light);
    lamp->name = name;
    scene_.light.sources.push_back(lamp);
  }

  Results results() const { return {scene_, gbuffer_, products_, composition_}; }

  std::vector<float> first_pixel(const NamedChannels& channels) const {
    std::vector<float> values;
    for (const NamedChannel& channel : channels.channels) values.push_back(channel.pixels[0]);
    return values;
  }

  glm::vec3 occluded(std::size_t pixel = 0) const { return composite(results()).color[pixel]; }

  Scene scene_;
  std::vector<LightGroup> lights_;
  GBuffer gbuffer_;
  Products products_;
  Composition composition_{Compose::occlude, false};
};

MATCHER_P(Near, expected, "") {
  for (int c = 0; c < 3; ++c)
    if (std::abs(arg[c] - (expected)[c]) > 1e-5f) return false;
  return true;
}

TEST_F(LightColors, AreThoseOfEachLightUnderItsName) {
  EXPECT_TRUE(light_channels("shadow", results()).empty()) << "not asked for";
  composition_.per_light = true;
  const auto shadow = light_channels("shadow", results()),
             unshadowed = light_channels("unshadowed", results());
  ASSERT_EQ(shadow.size(), 3u);
  EXPECT_EQ(shadow[0].channels[0].name, "shadow.env.R");
  EXPECT_EQ(shadow[1].channels[2].name, "shadow.key.B");
  EXPECT_THAT(first_pixel(shadow[0]), Pointwise(FloatNear(1e-6f), {0.5f, 0.25f, 0.75f}));
  EXPECT_THAT(first_pixel(shadow[1]), Pointwise(FloatNear(1e-6f), {0.25f, 0.25f, 0.25f}));
  EXPECT_THAT(first_pixel(shadow[2]), ElementsAre(0, 0, 1)) << "1 where there is no light";
  EXPECT_THAT(first_pixel(unshadowed[1]), ElementsAre(4, 2, 1));
  EXPECT_EQ(shadow[1].channels[0].pixels[1], 1) << "outside the geometry";
  EXPECT_EQ(unshadowed[1].channels[0].pixels[1], 0);
  EXPECT_TRUE(light_channels("ao", results()).empty());
}

TEST_F(LightColors, PicturesShowShadowAsItIs) {
  EXPECT_FALSE(needs_display("shadow"));
  EXPECT_TRUE(needs_display("unshadowed"));
  const DisplayImage image = make_display_image("shadow", results(), {});
  EXPECT_EQ(image.channels, 3);
  const std::vector<float> expected = first_pixel(product_channels("shadow", results()));
  EXPECT_THAT(std::vector<float>(image.values.begin(), image.values.begin() + 3),
              Pointwise(FloatNear(1e-6f), expected));
  const DisplayTransform raw({.view = "Raw"}, {});
  const DisplayImage light = make_display_image("unshadowed", results(), {&raw, true});
  const std::vector<float> unshadowed = first_pixel(product_channels("unshadowed", results()));
  EXPECT_THAT(std::vector<float>(light.values.begin(), light.values.begin() + 3),
              Pointwise(FloatNear(1e-5f), unshadowed));
}

TEST_F(LightColors, OccludeMultipliesALampsLayerByItsShadow) {
  gbuffer_.lights["key"] = Plane<glm::vec3>(2, 1, glm::vec3(1, 0.5f, 0.25f));
  EXPECT_THAT(occluded(), Near(glm::vec3(3, 2, 1) - 0.75f * glm::vec3(1, 0.5f, 0.25f)));
  EXPECT_EQ(occluded(1), glm::vec3(3, 2, 1)) << "the beauty outside the geometry";
  gbuffer_.lights["fill"] = Plane<glm::vec3>(2, 1, glm::vec3(0.5f));
  EXPECT_THAT(occluded(), Near(glm::vec3(3, 2, 1) - 0.75f * glm::vec3(1, 0.5f, 0.25f) -
                               glm::vec3(0.5f, 0.5f, 0.5f)));
}

/// Lamps make no ambient light: what hides it is what hides the environment.
TEST_F(LightColors, OccludeTakesTheShareOfTheEnvironmentForTheAmbientLayer) {
  gbuffer_.ambient = Plane<glm::vec3>(2, 1, glm::vec3(1, 0.8f, 0.4f));
  const glm::vec3 by_map = glm::vec3(3, 2, 1) - glm::vec3(1 * 0.5f, 0.8f * 0.75f, 0.4f * 0.25f);
  EXPECT_THAT(occluded(), Near(by_map));
  gbuffer_.lights["key"] = Plane<glm::vec3>(2, 1, glm::vec3(0.25f));
  EXPECT_THAT(occluded(), Near(by_map - 0.75f * glm::vec3(0.25f)));
  composition_.share_is_ao = true;
  EXPECT_THAT(occluded(), Near(glm::vec3(3, 2, 1) - 0.875f * glm::vec3(1, 0.8f, 0.4f) -
                               0.75f * glm::vec3(0.25f)));
}

TEST_F(LightColors, EdgesArePremultiplied) {
  gbuffer_.lights["key"] = Plane<glm::vec3>(2, 1, glm::vec3(1, 0.5f, 0.25f));
  gbuffer_.alpha = Plane<float>(2, 1, 1.0f);
  const glm::vec3 whole = occluded();
  for (glm::vec3& color : gbuffer_.beauty.pixels) color *= 0.25f;
  for (glm::vec3& color : gbuffer_.lights["key"].pixels) color *= 0.25f;
  gbuffer_.alpha = Plane<float>(2, 1, 0.25f);
  EXPECT_THAT(occluded(), Near(0.25f * whole));
}

}  // namespace
}  // namespace ssdo::test::light_colors_test
