// SPDX-License-Identifier: Apache-2.0
//
// What the prior does to light, to bent normals and to the expected error. As in prior_test.cpp,
// nothing here depends on the weights.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "estimators/bitmask/request.h"
#include "estimators/guessed.h"
#include "filters/light_visibility.h"
#include "parallel/task_order.h"
#include "parallel/tiles.h"
#include "prior/prior.h"
#include "support/point_source.h"

namespace ssdo::test::prior_light_test {
namespace {

const Window kDisplay{0, 0, 240, 120};

/// A floor, walls on the left and behind, with sky above them, and a ball.
Scene room_in(const Environment& light, float albedo = 0.6f, const Window& display = kDisplay) {
  const auto wall = [](const glm::dvec3& at, const glm::dvec3& normal) {
    return cut(plane(at, normal), [](const glm::dvec3& p) { return p.z < 2.5; });
  };
  const Surface room = all_of({plane({0, 0, 0}, {0, 0, 1}), wall({-3, 0, 0}, {1, 0, 0}),
                               wall({0, 6, 0}, {0, -1, 0}), sphere({0.5, 1, 0.7}, 0.7)});
  const Camera camera =
      look_at(camera_from_fov(70, display, 1), {0, -5, 1.6}, {0, 1, 0.9}, {0, 0, 1});
  Geometry geometry = geometry_of(room, camera, display);
  geometry.median_depth = 6;
  Scene scene = scene_of(std::move(geometry), light, albedo);
  scene.solids = guess_solids(scene.geometry);
  return scene;
}

/// A map of `size` x `size / 2` texels, by direction.
template <class Radiance>
Environment map_of(int size, const Radiance& radiance) {
  auto texels = std::make_shared<Plane<glm::vec3>>(size, size / 2);
  const Environment directions(texels, {.up = UpAxis::z});
  for (int y = 0; y < texels->height; ++y)
    for (int x = 0; x < texels->width; ++x)
      (*texels)(x, y) = glm::vec3(radiance(directions.texel_direction(x, y)));
  return Environment(std::move(texels), {.up = UpAxis::z});
}

/// From one side, and far more from there.
Environment one_sided() {
  return map_of(32, [](const glm::vec3& d) { return std::pow(std::max(d.x + 0.3f, 0.0f), 2.0f); });
}

/// A dim sky, and a sun that stands behind the camera.
Environment sunny() {
  const glm::vec3 sun = glm::normalize(glm::vec3(0.3f, -1, 0.8f));
  return map_of(256, [=](const glm::vec3& d) { return glm::dot(d, sun) > 0.9995f ? 3e3f : 0.1f; });
}

struct Found {
  Products products;
  std::optional<PriorField> field;
};

/// With the prior, or by rules.
Found find(const Scene& scene, const ProductSet& products, bool learned = true) {
  const Method method = bitmask_method();
  const glm::vec3 up(scene.geometry.camera.rotation * glm::dvec3(0, 0, 1));
  Request request{.products = products,
                  .radius = kNoLimit,
                  .bounces = products.bounce ? 2 : 0,
                  .parameters = {{"roughness", 0.5}, {"ior", 1.5}},
                  .visibility_suffices = true};
  request.products.guessed = false;
  Found found;
  if (learned) request.ask_prior = ask_prior({up, request.radius, request.seed}, found.field);
  Products noisy = method.estimate(scene, request, {});
  found.products = filter_visibility(find_filter("geometry"), std::move(noisy), scene,
                                     method.pattern_size, [&](Products& filtered) {
                                       if (learned) apply_prior(*found.field, scene, filtered);
                                     });
  if (learned) finish_with_prior(*found.field, scene, products.guessed, found.products);
  return found;
}

/// Calls visit(pixel, normal) for every surface.
template <class Visit>
void for_each_surface(const Scene& scene, const Visit& visit) {
  for (std::size_t i = 0; i < scene.geometry.surfaces.size(); ++i)
    if (scene.geometry.is_surface(i)) visit(i, scene.geometry.surfaces[i].normal);
}

double mean_change(const Plane<glm::vec3>& a, const Plane<glm::vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += double(glm::length(a[i] - b[i]));
  return sum / double(a.size());
}

TEST(PriorLight, OfAMapOfOneColourIsAo) {
  const Scene scene = room_in(map_of(32, [](const glm::vec3&) { return 1.0f; }));
  ASSERT_FALSE(scene.light.is_constant());
  const Products found = find(scene, {.ao = true, .direct = true}).products;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3& normal) {
    const glm::vec3 all = scene.light.unoccluded_sky(normal);
    ASSERT_NEAR(found.direct[i].x / all.x, found.ao[i], 2e-3) << i;
  });
}

TEST(PriorLight, LiesBetweenNoneAndWhatIsUnoccluded) {
  const Scene scene = room_in(one_sided());
  const Products found = find(scene, {.ao = true, .direct = true}).products,
                 rules = find(scene, {.ao = true, .direct = true}, false).products;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3& normal) {
    const glm::vec3 all = scene.light.unoccluded_sky(normal);
    for (int c = 0; c < 3; ++c)
      ASSERT_TRUE(found.direct[i][c] >= 0 && found.direct[i][c] <= all[c] * 1.00001f + 1e-6f)
          << found.direct[i][c] << " of " << all[c];
  });
  EXPECT_GT(mean_change(found.direct, rules.direct), 1e-3);
}

/// What is mirrored of the sky along guessed rays is open to the odds s / (1 - s) of the rules
/// times those of the prior; the rest of it stays as it is.
TEST(PriorLight, LeansWhatIsMirroredAlongGuessedRays) {
  const Scene scene = room_in(one_sided());
  PriorField field = *find(scene, {.ao = true, .direct = true}).field;
  ASSERT_EQ(field.part, 1) << "there is no radius";
  for (float& bias : field.visibility_bias.pixels) bias = 0.25f;
  const Surfaces& surfaces = scene.geometry.surfaces;
  const auto mirrored = [&](float share, float guessed, float open) {
    Products products;
    products.ao = Plane<float>(surfaces.width, surfaces.height, 0.5f);
    products.visibility.mirrored_sky = {surfaces.width, surfaces.height, glm::vec3(share)};
    products.visibility.mirrored_guessed = {surfaces.width, surfaces.height, guessed};
    products.visibility.mirrored_guessed_open = {surfaces.width, surfaces.height, open};
    apply_prior(field, scene, products);
    return products.visibility.mirrored_sky;
  };
  struct Case {
    float share, guessed, open, after;
  };
  for (const Case& c : {Case{0.4f, 0, 0, 0.4f},
                        {0.4f, 0.4f, 0.2f, 0.5f},
                        {0.6f, 0.5f, 0.25f, 0.725f},
                        {1, 0.5f, 0.25f, 1}}) {
    const Plane<glm::vec3> after = mirrored(c.share, c.guessed, c.open);
    for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
      ASSERT_NEAR(after[i].x, c.after, 1e-5f) << c.share << " of which " << c.guessed;
      ASSERT_EQ(after[i].x, after[i].z);
    });
  }
}

/// The march tells a prior which part of the mirrored sky comes along guessed rays, and which part
/// of that the rules let through.
TEST(PriorLight, IsToldWhatIsMirroredAlongGuessedRays) {
  const Scene scene = room_in(one_sided());
  Request request{.products = {.ao = true, .specular = true},
                  .radius = kNoLimit,
                  .parameters = {{"roughness", 0.5}, {"ior", 1.5}}};
  const auto estimate = [&] { return bitmask_method().estimate(scene, request, {}).visibility; };
  ASSERT_TRUE(estimate().mirrored_guessed.empty()) << "not looked for without a prior";
  std::optional<PriorField> field;
  request.ask_prior = ask_prior({std::nullopt, request.radius, request.seed}, field);
  const LightVisibility found = estimate();
  double sum = 0, open = 0, count = 0;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
    const float guessed = found.mirrored_guessed[i], part = found.mirrored_guessed_open[i];
    ASSERT_TRUE(guessed >= 0 && guessed <= 1.00001f) << guessed;
    ASSERT_TRUE(part >= 0 && part <= guessed + 1e-5f) << part << " of " << guessed;
    sum += double(guessed), open += double(part), count += 1;
  });
  EXPECT_GT(sum / count, 0.05);
  EXPECT_LT(sum / count, 0.95);
  EXPECT_GT(open, 0.05 * sum);
  EXPECT_LT(open, 0.95 * sum);
}

/// Of what no surface in the frame hides, all that the prior finds open is open for the sun.
TEST(PriorLight, OfASunComesWhereTheSkyDoes) {
  const Scene scene = room_in(sunny());
  ASSERT_EQ(scene.light.sources.size(), 1u);
  PriorField field = *find(scene, {.ao = true, .direct = true}).field;
  for (std::size_t i = 0; i < field.offscreen_sun.size(); ++i) {
    if (field.grid.pixel[i] == kNoPixel) continue;
    ASSERT_TRUE(field.offscreen_sun[i] >= 0 && field.offscreen_sun[i] <= 1)
        << field.offscreen_sun[i];
    const float unhidden = field.grid.open_ao[i], after = field.grid.ao[i] + field.change[i];
    if (after >= unhidden) {
      EXPECT_EQ(field.offscreen_sun[i], 1);
    } else if (after < unhidden - 0.01f) {
      EXPECT_LT(field.offscreen_sun[i], 1) << after << " of " << unhidden;
    }
  }
  std::fill(field.offscreen_sun.pixels.begin(), field.offscreen_sun.pixels.end(), 0.25f);
  for (const float rules : {0.25f, 1.0f}) {
    const LearnedVisibility learned = by_pixel(field, scene.geometry, rules);
    for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
      ASSERT_NEAR(learned.offscreen_sun[i], (0.25f + rules) / 2, 1e-6f) << "halfway to the rules";
    });
  }
}

/// The sun stands behind the camera: its rays leave the frame.
TEST(PriorLight, OfASunIsWhatThePriorLetsPass) {
  const Scene scene = room_in(sunny());
  const auto mean_share = [&](float past) {
    const Plane<float>& any = Plane<float>::like(scene.geometry.surfaces);
    Request request{.products = {.direct = true}, .radius = kNoLimit, .visibility_suffices = true};
    request.ask_prior = [&](const PriorQuestion& question) {
      EXPECT_TRUE(question.for_light);
      return LearnedVisibility{Plane<float>(any.width, any.height, 0.0f),
                               Plane<float>(any.width, any.height, past)};
    };
    const Plane<float> share =
        std::move(bitmask_method().estimate(scene, request, {}).visibility.sources.front());
    double sum = 0;
    for (const float s : share.pixels) sum += double(s) / double(share.size());
    return sum;
  };
  const double none = mean_share(0), half = mean_share(0.5f), all = mean_share(1);
  EXPECT_GT(all, none + 0.3);
  EXPECT_NEAR(half, (none + all) / 2, 1e-3);
}

/// What is not shown sends what the frame does of light from afar, and nothing of a lamp in it.
TEST(PriorLight, OfALampIsNotSentByWhatIsNotShown) {
  const ProductSet asked{.ao = true, .bounce = true};
  Scene scene = room_in(Environment::constant(glm::vec3(0)));
  const glm::dvec3 at = scene.geometry.camera.to_camera({0.5, 0, 2});
  scene.light.sources.push_back(std::make_shared<PointSource>(glm::vec3(at)));
  const Products found = find(scene, asked).products, rules = find(scene, asked, false).products;
  float most = 0;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
    most = std::max(most, rules.bounce[i].x);
    ASSERT_LE(found.bounce[i].x, 1.02f * rules.bounce[i].x + 1e-5f) << i;
  });
  EXPECT_GT(most, 0.01f);
  EXPECT_NE(found.ao.pixels, rules.ao.pixels);
}

/// Beside a lamp, the light from afar is told from one row in four of a frame of this height.
TEST(PriorLight, FromAfarIsSentByWhatIsNotShownAlsoBesideALamp) {
  const ProductSet asked{.ao = true, .bounce = true};
  const auto room_under = [](const glm::vec3& sky) {
    return room_in(Environment::constant(sky), 0.6f, {0, 0, 128, 512});
  };
  Scene scene = room_under({0.5f, 1, 2});
  const Plane<glm::vec3> of_sky = find(scene, asked).products.bounce;
  const glm::dvec3 at = scene.geometry.camera.to_camera({0.5, 0, 2});
  scene.light.sources.push_back(std::make_shared<PointSource>(glm::vec3(at)));
  const Plane<glm::vec3> of_both = find(scene, asked).products.bounce;
  scene.light = room_under(glm::vec3(0)).light;
  scene.light.sources.push_back(std::make_shared<PointSource>(glm::vec3(at)));
  const Plane<glm::vec3> of_lamp = find(scene, asked).products.bounce;
  glm::dvec3 sum(0), more(0);
  for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
    sum += of_sky[i], more += of_both[i] - of_lamp[i];
  });
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(more[c], sum[c], 0.01 * sum[c]);
}

/// Within a radius ao takes half of the change, and more with a radius far larger than the frame.
TEST(PriorLight, OfALargeRadiusIsNearlyThatWithoutOne) {
  const Geometry geometry = room_in(sunny()).geometry;
  const float height = geometry.frame_height_at(geometry.median_depth);
  EXPECT_EQ(part_of_ao(geometry, kNoLimit), 1);
  EXPECT_NEAR(part_of_ao(geometry, 0.1f * height), 0.5, 1e-3);
  EXPECT_NEAR(part_of_ao(geometry, 8 * height), 0.75, 1e-6);
  EXPECT_GT(part_of_ao(geometry, 1000 * height), 0.999f);
}

/// In a white world with white surfaces, ao + bounce is 1 where nothing is lost.
TEST(PriorLight, OfBouncesIsNotMadeFromNothing) {
  const Scene scene = room_in(Environment::constant(glm::vec3(1)), 1);
  const Products found = find(scene, {.ao = true, .bounce = true}).products,
                 rules = find(scene, {.ao = true, .bounce = true}, false).products;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
    ASSERT_GE(found.bounce[i].x, 0);
    ASSERT_LE(found.ao[i] + found.bounce[i].x, 1.01f) << i;
  });
  EXPECT_GT(mean_change(found.bounce, rules.bounce), 1e-3);
}

TEST(PriorLight, HasTheSameBitsWithAnyThreadsAndOrder) {
  const Scene scene = room_in(sunny());
  const ProductSet all{.ao = true, .direct = true, .bounce = true, .bent = true, .guessed = true};
  const Products one = [&] {
    const ThreadLimit limit(1);
    return find(scene, all).products;
  }();
  const ThreadLimit limit(3);
  const ShuffledOrder order{1};
  const Products two = find(scene, all).products;
  EXPECT_EQ(two.direct.pixels, one.direct.pixels);
  EXPECT_EQ(two.bounce.pixels, one.bounce.pixels);
  EXPECT_EQ(two.bent.pixels, one.bent.pixels);
  EXPECT_EQ(two.guessed.pixels, one.guessed.pixels);
}

TEST(Prior, LeansBentNormalsAndExpectsAnErrorWhereItGuesses) {
  const Scene scene = room_in(Environment::constant(glm::vec3(1)));
  const ProductSet asked{.ao = true, .bent = true, .guessed = true};
  const Found found = find(scene, asked);
  const Products &products = found.products, rules = find(scene, asked, false).products;
  double leaning = 0;
  for_each_surface(scene, [&](std::size_t i, const glm::vec3&) {
    ASSERT_NEAR(glm::length(products.bent[i]), 1, 1e-4);
    leaning = std::max(leaning, double(glm::distance(products.bent[i], rules.bent[i])));
  });
  EXPECT_GT(leaning, 0.02);
  bool has_background = false;
  for (std::size_t i = 0; i < products.guessed.size(); ++i) {
    const bool is_surface = scene.geometry.is_surface(i);
    has_background |= !is_surface;
    ASSERT_TRUE(products.guessed[i] >= 0 && products.guessed[i] <= float(is_surface)) << i;
  }
  EXPECT_TRUE(has_background);
  const PriorField& field = *found.field;
  for (std::size_t i = 0; i < field.spread.size(); ++i) {
    if (field.grid.guessed[i] > 0) continue;
    EXPECT_EQ(field.spread[i], 0);
    EXPECT_EQ(field.change[i], 0);
    for (const Plane<float>& moment : field.moment) EXPECT_EQ(moment[i], 0);
  }
}

}  // namespace
}  // namespace ssdo::test::prior_light_test
