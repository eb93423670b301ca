// SPDX-License-Identifier: Apache-2.0
#include "color/compose.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <memory>

#include "color/display_image.h"
#include "color/downsample.h"
#include "support/scene_of.h"

namespace ssdo::test::compose_test {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;

/// Two pixels, of which the second shows no surface.
class Composites : public testing::Test {
 protected:
  Composites() {
    Geometry g;
    g.window = g.display = {0, 0, 2, 1};
    g.surfaces = Surfaces(2, 1);
    g.surfaces.set(0, {{0, 0, -1}, {0, 0, 1}, 0});
    // A quarter of a turn about z: x of the input's normals is y of the camera.
    g.normals_to_camera = glm::mat3(glm::vec3(0, 1, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1));
    scene_ = scene_of(g, Environment::constant(glm::vec3(1)), 0.5f);
    for_each_plane(
        [](const Product& product, auto& plane) {
          plane = std::decay_t<decltype(plane)>(2, 1);
          plane[1] = std::decay_t<decltype(plane[1])>(product.background);
        },
        products_);
    products_.ao[0] = 0.75f;
    products_.reflection[0] = 0.25f;
    products_.error[0] = -0.125f;
    products_.direct[0] = {1, 2, 3};
    products_.bounce[0] = {0.5f, 0.25f, 0};
    products_.bent[0] = {0, 0.6f, 0.8f};
  }

  /// Channel names and the values of the first pixel.
  std::vector<std::pair<std::string, float>> channels(const std::string& product) const {
    std::vector<std::pair<std::string, float>> out;
    const NamedChannels found = product_channels(product, results());
    for (const NamedChannel& channel : found.channels)
      out.emplace_back(channel.name, *channel.pixels.at(0, 0));
    return out;
  }

  Results results() const { return {scene_, gbuffer_, products_, composition_}; }
  glm::vec3 composed(std::size_t pixel = 0) const { return composite(results()).color[pixel]; }

  /// Beauty and ambient layer of both pixels, and the composite to make of them.
  void render(const glm::vec3& beauty, const glm::vec3& ambient, Composition composition) {
    gbuffer_.beauty = Plane<glm::vec3>(2, 1, beauty);
    gbuffer_.ambient = Plane<glm::vec3>(2, 1, ambient);
    composition_ = composition;
  }

  /// Light of the map, and what it is on the first pixel's surface, from a sum over its texels.
  glm::dvec3 light_by(const std::function<glm::vec3(const glm::vec3&)>& radiance) {
    const auto map = std::make_shared<Plane<glm::vec3>>(128, 64);
    const Environment environment(map, {});
    glm::dvec3 sum(0);
    for (int y = 0; y < map->height; ++y) {
      const double pi = 3.14159265358979, top = pi * y / map->height,
                   solid_angle =
                       2 * pi / map->width * (std::cos(top) - std::cos(pi * (y + 1) / map->height));
      for (int x = 0; x < map->width; ++x) {
        const glm::vec3 d = environment.texel_direction(x, y);
        (*map)(x, y) = radiance(d);
        sum += glm::dvec3((*map)(x, y)) * std::max(0.0, double(d.z)) * solid_angle / pi;
      }
    }
    scene_.light = model_light(environment, glm::mat3(1));
    return sum;
  }

  Scene scene_;
  GBuffer gbuffer_;
  Products products_;
  Composition composition_;
};

using Channel = std::pair<std::string, float>;

TEST_F(Composites, EachProductHasItsChannels) {
  EXPECT_THAT(channels("ao"), ElementsAre(Channel("ao.Y", 0.75f)));
  EXPECT_THAT(channels("reflection"), ElementsAre(Channel("reflection.Y", 0.25f)));
  EXPECT_THAT(channels("error"), ElementsAre(Channel("error.Y", -0.125f)));
  EXPECT_THAT(channels("direct"),
              ElementsAre(Channel("direct.R", 1), Channel("direct.G", 2), Channel("direct.B", 3)));
  EXPECT_THAT(channels("bounce"), ElementsAre(Channel("bounce.R", 0.5f), Channel("bounce.G", 0.25f),
                                              Channel("bounce.B", 0)));
  EXPECT_THAT(channels("bent"),
              ElementsAre(Channel("bent.X", 0.6f), Channel("bent.Y", 0), Channel("bent.Z", 0.8f)))
      << "in the space of the input's normals";
}

TEST_F(Composites, ProductsOfTheirSizeAreWrittenFromWhereTheyAre) {
  const NamedChannels direct = product_channels("direct", results());
  EXPECT_EQ(direct.channels[1].pixels.first, &products_.direct[0].y);
  EXPECT_EQ(direct.channels[1].pixels.at(1, 0), &products_.direct[1].y);
  const NamedChannels ao = product_channels("ao", results());
  EXPECT_EQ(ao.channels[0].pixels.at(1, 0), &products_.ao[1]);
}

TEST_F(Composites, TheCompositeIsAlbedoTimesLightPremultiplied) {
  gbuffer_.alpha = Plane<float>(2, 1, 0.5f);
  EXPECT_THAT(channels("composite"), ElementsAre(Channel("R", 0.375f), Channel("G", 0.5625f),
                                                 Channel("B", 0.75f), Channel("A", 0.5f)));
  products_.bounce = {};
  EXPECT_THAT(channels("composite"), ElementsAre(Channel("R", 0.25f), Channel("G", 0.5f),
                                                 Channel("B", 0.75f), Channel("A", 0.5f)));
}

const Composition kByAo{Compose::occlude, true}, kByLight{Compose::occlude, false},
    kAdd{Compose::add, false};

void expect_near(const glm::vec3& found, const glm::dvec3& expected, double tolerance = 1e-6) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

TEST_F(Composites, OccludeTakesFromTheAmbientLayerWhatAoHides) {
  render(glm::vec3(1), glm::vec3(0.4f, 0.2f, 0), kByAo);
  expect_near(composed(), {0.9, 0.95, 1});
  gbuffer_.beauty = {};
  expect_near(composed(), {0.3, 0.15, 0});
}

TEST_F(Composites, OccludeGivesEachChannelTheShareOfItsLight) {
  const glm::dvec3 open = light_by([](const glm::vec3& d) {
    return d.x > 0 ? glm::vec3(2, 0.5f, 0.25f) : glm::vec3(0.25f, 0.5f, 1 + d.z);
  });
  const glm::dvec3 share(0.25, 0.5, 0.875);
  products_.direct[0] = glm::vec3(share * open);
  render(glm::vec3(3, 2, 1), glm::vec3(1, 0.8f, 0.6f), kByLight);
  expect_near(composed(), {3 - 1 * 0.75, 2 - 0.8 * 0.5, 1 - 0.6 * 0.125}, 2e-4);
  products_.direct[0] = glm::vec3(1.5 * open);
  expect_near(composed(), {3, 2, 1});
}

TEST_F(Composites, AChannelWithoutLightHasTheShareOfAllLight) {
  const glm::dvec3 open =
      light_by([](const glm::vec3& d) { return glm::vec3(1 + d.x, 3 - d.x, 0); });
  products_.direct[0] = glm::vec3(0.5 * open.x, 0.25 * open.y, 0);
  render(glm::vec3(1), glm::vec3(1), kByLight);
  expect_near(composed(), {0.5, 0.25, (0.5 * open.x + 0.25 * open.y) / (open.x + open.y)}, 2e-4);
  light_by([](const glm::vec3&) { return glm::vec3(0); });
  products_.direct[0] = glm::vec3(0);
  expect_near(composed(), {1, 1, 1});
}

TEST_F(Composites, ReflectionIsForTheSpecularLayer) {
  render(glm::vec3(2), glm::vec3(0.4f), kByAo);
  gbuffer_.specular = Plane<glm::vec3>(2, 1, glm::vec3(0.8f, 0.4f, 0));
  expect_near(composed(), {1.9 - 0.8 * 0.75, 1.9 - 0.4 * 0.75, 1.9});
}

TEST_F(Composites, OccludeMakesNoNegativeLight) {
  render(glm::vec3(0.1f, -0.1f, 0.5f), glm::vec3(1), kByAo);
  expect_near(composed(), {0, -0.1, 0.25});
}

TEST_F(Composites, AddPutsTheLightOnTheBeauty) {
  render(glm::vec3(1, 2, 3), glm::vec3(9), kAdd);
  gbuffer_.alpha = Plane<float>(2, 1, 0.5f);
  expect_near(composed(), {1 + 0.375, 2 + 0.5625, 3 + 0.75});
  EXPECT_EQ(composite(results()).alpha[0], 0.5f);
}

TEST_F(Composites, EdgesArePremultipliedInEveryComposite) {
  const glm::vec3 beauty(1, 0.5f, 0.25f), ambient(0.4f, 0.2f, 0.1f);
  for (const Composition& composition : {kByAo, kAdd}) {
    render(beauty, ambient, composition);
    gbuffer_.alpha = Plane<float>(2, 1, 1.0f);
    const glm::vec3 whole = composed();
    render(0.25f * beauty, 0.25f * ambient, composition);
    gbuffer_.alpha = Plane<float>(2, 1, 0.25f);
    expect_near(composed(), 0.25 * glm::dvec3(whole));
  }
}

TEST_F(Composites, OccludeAndAddKeepTheBeautyOutsideTheGeometry) {
  const glm::vec3 sky(1.1f, 1.2f, 1.6f);
  for (const Composition& composition : {kByAo, kByLight, kAdd}) {
    render(sky, glm::vec3(0.5f), composition);
    for (const float alpha : {1.0f, 0.0f, 0.3f}) {
      gbuffer_.alpha = Plane<float>(2, 1, alpha);
      EXPECT_EQ(composed(1), sky);
      EXPECT_EQ(composite(results()).alpha[1], alpha);
    }
    gbuffer_.alpha[1] = NAN;
    EXPECT_EQ(composite(results()).alpha[1], 0);
    gbuffer_.alpha = {};
    EXPECT_EQ(composite(results()).alpha[1], 0) << "coverage by geometry";
  }
  composition_ = {};
  EXPECT_EQ(composed(1), glm::vec3(0));
  EXPECT_EQ(composite(results()).alpha[1], 0);
}

TEST_F(Composites, PicturesShowTheSkyOfABeauty) {
  const DisplayTransform raw({.view = "Raw"}, {});
  render(glm::vec3(0.5f, 0.25f, 0.75f), glm::vec3(0), kByAo);
  gbuffer_.alpha = Plane<float>(2, 1, 1.0f);
  const std::vector<float> sky = {0.5f, 0.25f, 0.75f};
  const DisplayImage over_black = make_display_image("composite", results(), {&raw, false});
  EXPECT_THAT(std::vector<float>(over_black.values.begin() + 3, over_black.values.end()),
              Pointwise(FloatNear(1e-6f), sky));
  gbuffer_.alpha[1] = 0.5f;
  const DisplayImage straight = make_display_image("composite", results(), {&raw, true});
  EXPECT_THAT(std::vector<float>(straight.values.begin() + 4, straight.values.end()),
              Pointwise(FloatNear(1e-6f), {1.0f, 0.5f, 1.5f, 0.5f}));
}

TEST_F(Composites, CoverageIsAlphaOnSurfaces) {
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
  gbuffer_.alpha = Plane<float>(2, 1, 7.0f);
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
  gbuffer_.alpha[0] = NAN;
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
}

TEST_F(Composites, PicturesShowEachKindInItsWay) {
  const auto image = [&](const std::string& product) {
    return make_display_image(product, results(), {});
  };
  EXPECT_EQ(image("ao").channels, 1);
  EXPECT_THAT(image("ao").values, ElementsAre(0.75f, 1));
  EXPECT_THAT(image("error").values, ElementsAre(-0.125f, 0));
  EXPECT_EQ(image("bent").channels, 3);
  EXPECT_THAT(image("bent").values,
              Pointwise(FloatNear(1e-6f), {0.8f, 0.5f, 0.9f, 0.5f, 0.5f, 0.5f}));
  for (const char* light : {"direct", "bounce", "composite"}) EXPECT_TRUE(needs_display(light));
  for (const char* data : {"ao", "bent", "reflection", "error"}) EXPECT_FALSE(needs_display(data));
}

}  // namespace
}  // namespace ssdo::test::compose_test
