// SPDX-License-Identifier: Apache-2.0
//
// Filters average what arrives of the light and leave what normals make of it.
#include "filters/light_visibility.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/trigonometric.hpp>
#include <memory>

#include "estimators/registry.h"
#include "support/analytic_scene.h"
#include "support/chosen_isa.h"
#include "support/random_frame.h"
#include "support/scene_of.h"
#include "support/sun_of.h"

namespace ssdo::test::light_visibility_test {
namespace {

const Window kWindow{0, 0, 96, 64};

const Camera& camera() {
  static const Camera c = look_at(camera_from_ortho_width(6, kWindow, 1), {0, 0, 5}, {}, {0, 1, 0});
  return c;
}

/// Normals of a map of waves along x, which lean up to `degrees`.
void add_waves(Geometry& g, double length_px, double degrees = 15) {
  for (int y = 0; y < g.surfaces.height; ++y) {
    for (int x = 0; x < g.surfaces.width; ++x) {
      const double lean = glm::radians(degrees) * std::sin(2 * 3.14159265358979 * x / length_px);
      g.surfaces.set_normal(g.surfaces.index(x, y), glm::vec3(std::sin(lean), 0, std::cos(lean)));
    }
  }
}

/// Light of the half above the plane, stronger on one side; with or without a sun 35 degrees high.
Environment light_from_a_side(bool sun, float sky = 1) {
  const auto map = std::make_shared<Plane<glm::vec3>>(256, 128);
  const Environment directions(map, {});
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) {
      const glm::vec3 d = directions.texel_direction(x, y);
      (*map)(x, y) = sky * (d.z > 0 ? d.z * (glm::vec3(1.2f) + d.x) : glm::vec3(0));
    }
  }
  const double height = glm::radians(35.0);
  const glm::vec2 at = directions.texel_at(glm::vec3(std::cos(height), 0, std::sin(height)));
  if (sun) (*map)(int(at.x), int(at.y)) = glm::vec3(20000, 18000, 15000);
  return Environment(map, {});
}

Products estimated(const Method& method, const Scene& scene, ProductSet products, int bounces = 0) {
  return method.estimate(scene,
                         {.products = products & method.products,
                          .radius = 1,
                          .bounces = bounces,
                          .parameters = resolve_parameters(method, {})},
                         {});
}

Products through_filter(const Method& method, const Scene& scene, const Products& noisy,
                        std::string_view filter = "geometry") {
  return filter_visibility(find_filter(filter), noisy, scene, method.pattern_size);
}

/// The slope of `found` over `expected`, pixel by pixel, away from the border.
template <class Found, class Expected>
double contrast(const Found& found, const Expected& expected) {
  double sum_e = 0, sum_f = 0, count = 0;
  const auto each = [](const auto& visit) {
    for (int y = 12; y < kWindow.height() - 12; ++y)
      for (int x = 16; x < kWindow.width() - 16; ++x) visit(x, y);
  };
  each([&](int x, int y) { sum_e += expected(x, y), sum_f += found(x, y), count += 1; });
  double covariance = 0, variance = 0;
  each([&](int x, int y) {
    const double e = expected(x, y) - sum_e / count;
    covariance += e * (found(x, y) - sum_f / count), variance += e * e;
  });
  return covariance / variance;
}

TEST(Shares, ContrastOfNormalMapsIsKept) {
  for (const char* name : {"bitmask", "ssdo", "trace", "ssao"}) {
    const Method& method = find_method(name);
    for (const double length_px : {5.0, 8.0, 16.0}) {
      for (const bool sun : {true, false}) {
        Geometry g = geometry_of(plane({}, {0, 0, 1}), camera(), kWindow);
        add_waves(g, length_px);
        const Scene scene = scene_of(g, light_from_a_side(sun));
        ASSERT_EQ(scene.light.sources.size(), sun ? 1u : 0u);
        const Products noisy = estimated(method, scene, {.ao = true, .direct = true, .bent = true}),
                       out = through_filter(method, scene, noisy);
        const auto light = [&](int x, int y) {
          return double(scene.light.unoccluded({}, scene.geometry.surfaces(x, y).normal).y);
        };
        const auto green = [](const Products& p) {
          return [&p](int x, int y) { return double(p.direct(x, y).y); };
        };
        const double kept = contrast(green(out), light), before = contrast(green(noisy), light);
        fmt::print("{}, waves of {} px{}: contrast {:.3f}, unfiltered {:.3f}\n", name, length_px,
                   sun ? " in the sun" : "", kept, before);
        EXPECT_GT(kept, 0.97);
        EXPECT_LT(kept, 1.03);
        if (out.bent.empty()) continue;
        // The plane itself hides what lies below it from normals that lean.
        const auto normal = [&](int x, int y) {
          return double(scene.geometry.surfaces(x, y).normal.x);
        };
        const auto bent = [](const Products& p) {
          return [&p](int x, int y) { return double(p.bent(x, y).x); };
        };
        EXPECT_GT(contrast(bent(out), normal), 0.97 * contrast(bent(noisy), normal));
        EXPECT_LT(contrast(bent(out), normal), 1.03);
      }
    }
  }
}

TEST(Shares, BentOnAnOpenSurfaceIsItsNormal) {
  Geometry g = geometry_of(plane({}, {0, 0, 1}), camera(), kWindow);
  add_waves(g, 7, 20);
  const Scene scene = scene_of(g);
  Products p;
  p.bent = Plane<glm::vec3>::like(g.surfaces);
  for (std::size_t i = 0; i < p.bent.size(); ++i) p.bent[i] = g.surfaces[i].normal;
  for (const Filter& filter : filters()) {
    const Products out = filter_visibility(filter, p, scene, 8);
    for (std::size_t i = 0; i < p.bent.size(); ++i)
      EXPECT_LT(difference(out.bent[i], g.surfaces[i].normal), 1e-6) << filter.name;
  }
}

TEST(Shares, AFurnaceStaysExactAcrossAContactEdge) {
  // A white box on a white floor: direct + bounce is 1 before the filter, and after it.
  const Surface wall =
      cut(plane({0, 0.4, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0 && p.z < 0.5; });
  const Surface room = all_of({plane({}, {0, 0, 1}), wall});
  const Camera from_above =
      look_at(camera_from_fov(40, kWindow, 1), {0.3, -3, 2.5}, {0, 0, 0.1}, {0, 0, 1});
  Scene scene =
      scene_of(geometry_of(room, from_above, kWindow), Environment::constant(glm::vec3(1)));
  scene.senders.radiance = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(1));
  const Method& method = find_method("bitmask");
  const Products out = through_filter(
      method, scene, estimated(method, scene, {.ao = true, .direct = true, .bounce = true}, 1));
  double worst = 0, least = 1;
  for (std::size_t i = 0; i < out.direct.size(); ++i) {
    if (!scene.geometry.is_surface(i)) continue;
    worst = std::max(worst, difference(out.direct[i] + out.bounce[i], glm::dvec3(1)));
    least = std::min(least, double(out.ao[i]));
  }
  EXPECT_LT(least, 0.6) << "there is a contact";
  EXPECT_LT(worst, 0.01);
}

TEST(Shares, TheEdgeOfAShadowStaysWhereItIs) {
  Geometry g = geometry_of(plane({}, {0, 0, 1}), camera(), kWindow);
  add_waves(g, 8);
  const Scene scene = scene_of(g, light_from_a_side(true));
  constexpr int kEdge = 47;
  Products p;
  p.ao = Plane<float>(kWindow.width(), kWindow.height(), 1);
  p.visibility.sky = p.direct = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(1));
  p.visibility.sources = {Plane<float>(kWindow.width(), kWindow.height(), 0)};
  for (int y = 0; y < kWindow.height(); ++y)
    for (int x = kEdge; x < kWindow.width(); ++x) p.visibility.sources[0](x, y) = 1;
  const Products out = filter_visibility(find_filter("geometry"), p, scene, 8);
  const DistantSource& sun = sun_of(scene.light);
  const int y = kWindow.height() / 2;
  for (int x = 8; x < kWindow.width() - 8; ++x) {
    const glm::vec3 n = g.surfaces(x, y).normal;
    const double arrives = double(out.direct(x, y).x - scene.light.irradiance(n).x) /
                           double(sun.irradiance.x * std::max(0.0f, glm::dot(n, sun.direction)));
    // Four pixels are averaged whatever they show.
    const bool dark = x < kEdge;
    EXPECT_NEAR(arrives, dark ? 0 : 1, x < kEdge - 2 || x >= kEdge + 2 ? 0.1 : 0.5) << x;
  }
}

TEST(Shares, AreOfTheLightThatTheNormalReceives) {
  Geometry g = geometry_of(plane({}, {0, 0, 1}), camera(), kWindow);
  add_waves(g, 11, 70);  // some face away from the sun
  const Scene scene = scene_of(g, light_from_a_side(true, 0.01f));
  Products p;
  p.ao = Plane<float>(kWindow.width(), kWindow.height(), 0.5f);
  p.direct = Plane<glm::vec3>::like(g.surfaces);
  for (std::size_t i = 0; i < p.direct.size(); ++i)
    p.direct[i] = 0.7f * scene.light.unoccluded({}, g.surfaces[i].normal);
  const Products shares = to_visibility(p, scene);
  for (const glm::vec3& share : shares.direct.pixels)
    EXPECT_LT(difference(share, glm::dvec3(0.7)), 1e-4);

  Products parts;
  parts.direct = p.direct;
  parts.visibility.sky =
      Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0.3f, 2, -1));
  parts.visibility.sources = {Plane<float>(kWindow.width(), kWindow.height(), 0.6f)};
  const Products light = from_visibility(to_visibility(parts, scene), scene);
  EXPECT_TRUE(light.visibility.sky.empty() && light.visibility.sources.empty());
  for (std::size_t i = 0; i < p.direct.size(); ++i) {
    const glm::vec3 n = g.surfaces[i].normal;
    const DistantSource& sun = sun_of(scene.light);
    const glm::vec3 expected = glm::vec3(0.3f, 1, 0) * scene.light.irradiance(n) +
                               0.6f * std::max(0.0f, glm::dot(n, sun.direction)) * sun.irradiance;
    EXPECT_LT(difference(light.direct[i], expected), 1e-5 * (1 + glm::length(expected)));
  }
}

TEST(Shares, SufficeForTheLight) {
  const Surface things = all_of({plane({}, {0, 0, 1}), sphere({0.3, 0.2, 0.5}, 0.6)});
  const Method& bitmask = find_method("bitmask");
  for (const Environment& light : {light_from_a_side(true), Environment::constant({1, 0.5f, 2})}) {
    const Scene scene = scene_of(geometry_of(things, camera(), kWindow), light);
    Request request{.products = {.ao = true, .direct = true},
                    .radius = 1,
                    .parameters = resolve_parameters(bitmask, {})};
    const Products found = bitmask.estimate(scene, request, {});
    request.visibility_suffices = true;
    const Products shares = bitmask.estimate(scene, request, {});
    EXPECT_FALSE(found.direct.empty());
    EXPECT_TRUE(shares.direct.empty());
    EXPECT_EQ(through_filter(bitmask, scene, found).direct.pixels,
              through_filter(bitmask, scene, shares).direct.pixels);
  }
}

TEST(Shares, WhereNoLightFallsAoIsTheShare) {
  const Geometry g = geometry_of(plane({}, {0, 0, 1}), camera(), kWindow);
  const Scene scene = scene_of(g, Environment::constant({1, 0, 2}));
  Products p;
  p.ao = Plane<float>(kWindow.width(), kWindow.height(), 0.25f);
  p.direct = Plane<glm::vec3>(kWindow.width(), kWindow.height(), glm::vec3(0.5f, 0, 0.5f));
  const Products shares = to_visibility(p, scene);
  EXPECT_EQ(shares.direct(5, 5), glm::vec3(0.5f, 0.25f, 0.25f));
  EXPECT_EQ(from_visibility(shares, scene).direct(5, 5), p.direct(5, 5));
}

TEST(Shares, EveryMethodComposesWhatItFound) {
  // Without a filter the bits stay; shares taken and given back change the last digits.
  const Surface scene_surface = all_of({plane({}, {0, 0, 1}), sphere({0.3, 0.2, 0.5}, 0.6)});
  for (const Method& method : methods()) {
    if (!method.products.direct) continue;
    SCOPED_TRACE(method.name);
    Geometry g = geometry_of(scene_surface, camera(), kWindow);
    const Scene scene = scene_of(g, light_from_a_side(true, 1));
    const ProductSet set = {.ao = true, .direct = true, .bent = true};
    const Products noisy = estimated(method, scene, set);
    const Products none = through_filter(method, scene, noisy, "none");
    EXPECT_EQ(none.direct.pixels, noisy.direct.pixels);
    EXPECT_TRUE(none.visibility.sky.empty() && none.visibility.sources.empty());
    EXPECT_EQ(noisy.visibility.sources.size(),
              noisy.visibility.sky.empty() ? 0 : scene.light.sources.size());
    const Products composed = from_visibility(to_visibility(noisy, scene), scene);
    int off = 0;
    for (std::size_t i = 0; i < noisy.direct.size(); ++i) {
      off += difference(composed.direct[i], noisy.direct[i]) >
             1e-5 * (1 + glm::length(noisy.direct[i]));
      if (noisy.bent.empty()) continue;
      EXPECT_LT(difference(composed.bent[i], noisy.bent[i]), 1e-5);
    }
    // gtao looks light up along the bent normal, where there may be more than twice as much.
    EXPECT_LE(off, method.name == "gtao" ? int(noisy.direct.size() / 50) : 0);
  }
}

TEST(Shares, ConstantLightNeedsAoAlone) {
  Geometry g =
      geometry_of(all_of({plane({}, {0, 0, 1}), sphere({0.3, 0.2, 0.5}, 0.6)}), camera(), kWindow);
  const Scene scene = scene_of(g, Environment::constant({2, 1, 0.5f}));
  for (const char* name : {"bitmask", "trace", "hbao"}) {
    SCOPED_TRACE(name);
    const Method& method = find_method(name);
    const Products out =
        through_filter(method, scene, estimated(method, scene, {.ao = true, .direct = true}));
    for (std::size_t i = 0; i < out.direct.size(); ++i)
      EXPECT_LT(difference(out.direct[i], glm::dvec3(2, 1, 0.5) * double(out.ao[i])), 1e-5);
  }
}

TEST(Shares, AgreeAmongInstructionSets) {
  if (!has_isa("scalar")) GTEST_SKIP() << "a build for one instruction set";
  for (const Size size : kSizes) {
    const Scene scene =
        scene_of(random_geometry(size.width, size.height, 3), light_from_a_side(true));
    Products parts = random_products(scene.geometry, 4), whole = parts;
    parts.visibility.sources.resize(1);
    whole.visibility.sky = {}, whole.visibility.sources.clear();
    for (const Products& in : {parts, whole}) {
      const auto run = [&](const char* isa) {
        const ChosenIsa chosen(isa);
        return from_visibility(to_visibility(in, scene), scene);
      };
      const Products scalar = run("scalar");
      for (const char* isa : kVectorIsas) {
        if (!has_isa(isa)) continue;
        const Products vector = run(isa);
        for (std::size_t i = 0; i < in.ao.size(); ++i) {
          EXPECT_LT(difference(vector.direct[i], scalar.direct[i]),
                    1e-5 * (1 + glm::length(scalar.direct[i])));
          EXPECT_LT(difference(vector.bent[i], scalar.bent[i]), 1e-5);
        }
      }
    }
  }
}

TEST(Shares, BackgroundStaysBlackWhateverItHolds) {
  const Geometry g = random_geometry(70, 30, 11);
  Scene scene = scene_of(g, light_from_a_side(true));
  Products p = random_products(g, 12);
  p.visibility.sources.resize(1);
  for (std::size_t i = 0; i < p.ao.size(); ++i) {
    if (g.is_surface(i)) continue;
    scene.geometry.surfaces.set(i, {glm::vec3(NAN), glm::vec3(NAN), NAN});
    p.visibility.sky[i] = glm::vec3(NAN);
  }
  const Products out = filter_visibility(find_filter("geometry"), p, scene, 8);
  for (std::size_t i = 0; i < p.ao.size(); ++i) {
    EXPECT_TRUE(std::isfinite(glm::length(out.direct[i])));
    EXPECT_TRUE(g.is_surface(i) || out.direct[i] == glm::vec3(0));
  }
}

/// A ball on the ground, seen from above: what is guessed beside and on it is the same on every
/// side, and the sampling pattern is not.
TEST(Shares, GuessesHaveNoPattern) {
  const Scene scene = scene_of(
      geometry_of(all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.8}, 0.6)}), camera(), kWindow));
  const int width = kWindow.width(), height = kWindow.height();
  for (const char* name : {"bitmask", "trace"}) {
    const Method& method = find_method(name);
    const Plane<float> guessed =
        through_filter(method, scene, estimated(method, scene, {.guessed = true})).guessed;
    double sum = 0, sum2 = 0;
    int count = 0;
    for (int v = 0; v < height / 2; ++v) {
      for (int u = 0; u <= v; ++u) {
        if (std::hypot(u + 0.5, v + 0.5) > 16) continue;
        double all = 0, all2 = 0;
        for (const auto& [x, y] : {std::pair(u, v), std::pair(v, u)}) {
          for (const int column : {width / 2 + x, width / 2 - 1 - x}) {
            for (const int row : {height / 2 + y, height / 2 - 1 - y}) {
              const double g = double(guessed(column, row));
              all += g, all2 += g * g;
            }
          }
        }
        sum += all / 8, sum2 += all2 / 8 - all * all / 64, ++count;
      }
    }
    const double deviation = std::sqrt(sum2 / count);
    fmt::print("{}: {:.3f} guessed, deviation {:.4f}\n", name, sum / count, deviation);
    EXPECT_GT(sum / count, 0.04) << name;
    EXPECT_LT(deviation, 0.005) << name;
  }
}

}  // namespace
}  // namespace ssdo::test::light_visibility_test
