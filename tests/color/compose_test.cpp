// SPDX-License-Identifier: Apache-2.0
#include "color/compose.h"

#include <gmock/gmock.h>

#include "color/display_image.h"
#include "support/scene_of.h"

namespace ssdo::test {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;

/// Two pixels, of which the second shows no surface.
class Compose : public testing::Test {
 protected:
  Compose() {
    Geometry g;
    g.window = g.display = {0, 0, 2, 1};
    g.surfel = Plane<Surfel>(2, 1);
    g.surfel[0].position = {0, 0, -1}, g.surfel[0].valid = 1;
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
    for (const NamedPlane& plane : product_channels(product, scene_, gbuffer_, products_))
      out.emplace_back(plane.channel, plane.pixels[0]);
    return out;
  }

  Scene scene_;
  GBuffer gbuffer_;
  Products products_;
};

using Channel = std::pair<std::string, float>;

TEST_F(Compose, EachProductHasItsChannels) {
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

TEST_F(Compose, TheCompositeIsAlbedoTimesLightPremultiplied) {
  gbuffer_.alpha = Plane<float>(2, 1, 0.5f);
  EXPECT_THAT(channels("composite"), ElementsAre(Channel("R", 0.375f), Channel("G", 0.5625f),
                                                 Channel("B", 0.75f), Channel("A", 0.5f)));
  products_.bounce = {};
  EXPECT_THAT(channels("composite"), ElementsAre(Channel("R", 0.25f), Channel("G", 0.5f),
                                                 Channel("B", 0.75f), Channel("A", 0.5f)));
}

TEST_F(Compose, AmbientLightIsWhatAoTakesFrom) {
  gbuffer_.ambient = Plane<glm::vec3>(2, 1, glm::vec3(0.4f));
  EXPECT_NEAR(channels("composite")[0].second, 0.3f, 1e-6f);
  gbuffer_.beauty = Plane<glm::vec3>(2, 1, glm::vec3(1));
  EXPECT_NEAR(channels("composite")[0].second, 0.9f, 1e-6f) << "lamps stay";
}

TEST_F(Compose, CoverageIsAlphaOnSurfaces) {
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
  gbuffer_.alpha = Plane<float>(2, 1, 7.0f);
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
  gbuffer_.alpha[0] = NAN;
  EXPECT_THAT(coverage(scene_, gbuffer_).pixels, ElementsAre(1, 0));
}

TEST_F(Compose, PicturesShowEachKindInItsWay) {
  const auto image = [&](const std::string& product) {
    return make_display_image(product, scene_, gbuffer_, products_, {});
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
}  // namespace ssdo::test
