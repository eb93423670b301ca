// SPDX-License-Identifier: Apache-2.0
//
// Composites of a beauty through the binary: occlude, which darkens what the surroundings light,
// and add. What each pixel should be is computed here from the layers of the frame and from the
// products that the same run writes.
#include <gmock/gmock.h>

#include <functional>
#include <glm/common.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "scene/light/environment.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::ambient_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const glm::vec3 kLamp(2, 1.5f, 1), kAmbient(0.5f, 0.25f, 0.125f), kSky(1.1f, 1.2f, 1.6f);

/// A ball on a round table, with sky around it.
Picture ball_on_table() {
  const Window window{0, 0, 64, 48};
  const Surface table = cut(plane({}, {0, 0, 1}),
                            [](const glm::dvec3& p) { return p.x * p.x + p.y * p.y < 1.5 * 1.5; });
  return take_picture(all_of({table, sphere({0.2, 0, 0.5}, 0.5)}),
                      look_at(camera_from_fov(55, window, 1), {0, -3, 2.2}, {0, 0, 0.2}, {0, 0, 1}),
                      window);
}

/// That picture with the light of a lamp and ambient light, each times alpha, and an opaque sky.
FramePart rendered(const Picture& picture, float alpha = 1) {
  FramePart part = frame_of(picture);
  const int w = picture.window.width(), h = picture.window.height();
  Plane<glm::vec3> ambient(w, h), beauty(w, h);
  Plane<float> coverage(w, h);
  for (std::size_t i = 0; i < ambient.size(); ++i) {
    ambient[i] = picture.valid[i] ? alpha * kAmbient : glm::vec3(0);
    beauty[i] = picture.valid[i] ? alpha * kLamp + ambient[i] : kSky;
    coverage[i] = picture.valid[i] ? alpha : 1;
  }
  part.add("ViewLayer.Combined", beauty, "RGB");
  part.channels["ViewLayer.Combined.A"] = coverage;
  part.add("ViewLayer.Sky", ambient, "RGB");
  return part;
}

const std::vector<std::string> kAmbientLayer = {"--aov", "ambient=ViewLayer.Sky"};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Runs the tool on in.exr, and expects that it has nothing to say.
void compose(const TempDir& dir, const std::vector<std::string>& flags) {
  const Finished done = run_tool(std::vector<std::string>{dir / "in.exr", "-o", dir / "out.exr",
                                                          "--overwrite", "--pixel-type", "float"} +
                                 flags);
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
}

Plane<glm::vec3> colors(const TempDir& dir, const std::string& layer = "") {
  const Plane<float> r = channel(dir / "out.exr", layer + "R"),
                     g = channel(dir / "out.exr", layer + "G"),
                     b = channel(dir / "out.exr", layer + "B");
  Plane<glm::vec3> out(r.width, r.height);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = {r[i], g[i], b[i]};
  return out;
}

/// The composite is `expected(pixel)` on surfaces and the sky of the beauty elsewhere, to the bit.
void expect_composite(const TempDir& dir, const Picture& picture,
                      const std::function<glm::vec3(std::size_t)>& expected,
                      float tolerance = 1e-6f, float alpha = 1) {
  const Plane<glm::vec3> found = colors(dir);
  const Plane<float> coverage = channel(dir / "out.exr", "A");
  std::size_t sky = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(coverage[i], picture.valid[i] ? alpha : 1.0f);
    if (!picture.valid[i]) {
      EXPECT_EQ(found[i], kSky);
      ++sky;
      continue;
    }
    const glm::vec3 off = glm::abs(found[i] - expected(i));
    ASSERT_LE(std::max({off.x, off.y, off.z}), tolerance) << "pixel " << i;
  }
  EXPECT_GT(sky, 100);
  EXPECT_LT(sky, found.size() - 1000);
}

/// A map, y up as OpenEXR has it: red light from +x, blue from -x.
Environment two_lights() {
  const auto map = std::make_shared<Plane<glm::vec3>>(128, 64);
  const Environment environment(map, {});
  for (int y = 0; y < map->height; ++y) {
    for (int x = 0; x < map->width; ++x) {
      const float side = environment.texel_direction(x, y).x;
      (*map)(x, y) = glm::vec3(0.2f) + glm::vec3(std::max(side, 0.0f), 0, std::max(-side, 0.0f));
    }
  }
  return environment;
}

std::string write_map(const TempDir& dir, const Environment& environment) {
  const Plane<glm::vec3>& map = *environment.map();
  FramePart part{"", {0, 0, map.width, map.height}, {0, 0, map.width, map.height}, {}, Imf::FLOAT,
                 {}};
  part.add("x", map, "RGB");
  write_frame(dir / "map.exr", part);
  return dir / "map.exr";
}

/// What a surface of this normal gets of the map with nothing in its way: a sum over the texels.
glm::dvec3 unoccluded(const Environment& environment, const glm::vec3& normal) {
  const Plane<glm::vec3>& map = *environment.map();
  const double pi = 3.14159265358979;
  glm::dvec3 sum(0);
  for (int y = 0; y < map.height; ++y) {
    const double band = std::cos(pi * y / map.height) - std::cos(pi * (y + 1) / map.height);
    for (int x = 0; x < map.width; ++x) {
      const double cosine = glm::dot(environment.texel_direction(x, y), normal);
      sum += glm::dvec3(map(x, y)) * std::max(cosine, 0.0) * (2 / double(map.width) * band);
    }
  }
  return sum;
}

TEST(Ambient, OnlyTheAmbientPartOfABeautyIsOccluded) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  for (const float alpha : {1.0f, 0.5f}) {
    write_frame(dir / "in.exr", rendered(picture, alpha));
    compose(dir, kAmbientLayer);
    const Plane<float> ao = channel(dir / "out.exr", "ao.Y");
    const auto expected = [&](std::size_t i) { return alpha * (kLamp + ao[i] * kAmbient); };
    expect_composite(dir, picture, expected, 1e-6f, alpha);
    EXPECT_LT(*std::min_element(ao.pixels.begin(), ao.pixels.end()), 0.8f) << "nothing is hidden";
  }
}

TEST(Ambient, IsTheWholeCompositeWithoutABeautyAndNeedsNoAlbedo) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  FramePart part = rendered(picture);
  std::erase_if(part.channels, [](const auto& item) {
    return item.first.starts_with("ViewLayer.Combined.") ||
           item.first.starts_with("ViewLayer.DiffCol.");
  });
  write_frame(dir / "in.exr", part);
  compose(dir, kAmbientLayer);
  const Plane<float> ao = channel(dir / "out.exr", "ao.Y");
  const Plane<glm::vec3> found = colors(dir);
  for (std::size_t i = 0; i < ao.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[i][c], picture.valid[i] ? ao[i] * kAmbient[c] : 0.0f, 1e-6f);
  }
}

/// The ball hides the red light of what stands to its left, and the blue light to its right.
TEST(Ambient, ShadowsOfColouredLightAreColoured) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  const Environment environment = two_lights();
  write_frame(dir / "in.exr", rendered(picture));
  compose(dir,
          kAmbientLayer + std::vector<std::string>{"--env", write_map(dir, environment), "--env-up",
                                                   "y", "--products", "direct,composite"});
  const Plane<glm::vec3> direct = colors(dir, "direct.");
  Plane<glm::vec3> share = direct;
  for (std::size_t i = 0; i < share.size(); ++i) {
    if (picture.valid[i])
      share[i] = glm::min(direct[i] / glm::vec3(unoccluded(environment, picture.normal[i])), 1.0f);
  }
  expect_composite(
      dir, picture, [&](std::size_t i) { return kLamp + share[i] * kAmbient; }, 2e-3f);
  const auto beside = [&](double x) {
    const glm::dvec2 pixel = picture.camera.project(picture.camera.to_camera({x, 0, 0}));
    return share(int(pixel.x), int(pixel.y));
  };
  EXPECT_LT(beside(-0.3).x + 0.2f, beside(-0.3).z) << "red is hidden";
  EXPECT_LT(beside(0.7).z + 0.2f, beside(0.7).x) << "blue is hidden";
}

/// Methods find direct light by rays, by samples in the picture, along the bent normal, or as ao
/// times the light of the normal.
class AmbientByMethod : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, AmbientByMethod, testing::Values("trace", "ssdo", "gtao", "msvo"),
                         [](const auto& method) { return std::string(method.param); });

TEST_P(AmbientByMethod, IsOccludedByDirectOverUnoccludedLight) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  const Environment environment = two_lights();
  write_frame(dir / "in.exr", rendered(picture));
  compose(dir, kAmbientLayer + std::vector<std::string>{"--env", write_map(dir, environment),
                                                        "--env-up", "y", "--method", GetParam(),
                                                        "--products", "direct,composite"});
  const Plane<glm::vec3> direct = colors(dir, "direct.");
  const auto expected = [&](std::size_t i) {
    const glm::vec3 open(unoccluded(environment, picture.normal[i]));
    return kLamp + glm::min(direct[i] / open, 1.0f) * kAmbient;
  };
  expect_composite(dir, picture, expected, 2e-3f);
}

TEST(Ambient, BouncesThatGtaoCountsReachTheComposite) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  FramePart part = rendered(picture);
  const glm::dvec3 albedo(0.875, 0.5, 0.125);  // exact in half numbers
  part.add("ViewLayer.DiffCol", Plane<glm::vec3>(64, 48, glm::vec3(albedo)), "RGB");
  write_frame(dir / "in.exr", part);
  compose(dir, kAmbientLayer + std::vector<std::string>{"--method", "gtao", "--set",
                                                        "multi-bounce=1", "--filter", "none"});
  const Plane<float> ao = channel(dir / "out.exr", "ao.Y");
  // Jimenez et al. 2016, equation 10.
  const auto expected = [&](std::size_t i) {
    glm::vec3 light = kLamp;
    for (int c = 0; c < 3; ++c) {
      const double a = 2.0404 * albedo[c] - 0.3324, b = -4.7951 * albedo[c] + 0.6417,
                   d = 2.7552 * albedo[c] + 0.6903, v = ao[i];
      light[c] += kAmbient[c] * float(std::min(std::max(v, ((v * a + b) * v + d) * v), 1.0));
    }
    return light;
  };
  expect_composite(dir, picture, expected, 1e-5f);
  const std::size_t darkest =
      std::size_t(std::min_element(ao.pixels.begin(), ao.pixels.end()) - ao.pixels.begin());
  EXPECT_GT(expected(darkest).x, kLamp.x + kAmbient.x * (ao[darkest] + 0.1f));
}

TEST(Ambient, TheSpecularLayerIsMultipliedByReflection) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  FramePart part = rendered(picture);
  const glm::vec3 specular(0.1f, 0.2f, 0.3f);
  part.add("ViewLayer.Env", Plane<glm::vec3>(64, 48, specular), "RGB");
  part.channels["ViewLayer.roughness.Y"] = Plane<float>(64, 48, 0.3f);
  write_frame(dir / "in.exr", part);
  const std::vector<std::string> flags =
      kAmbientLayer + std::vector<std::string>{"--aov", "specular=ViewLayer.Env", "--products",
                                               "ao,reflection,composite"};
  compose(dir, flags);
  const Plane<float> ao = channel(dir / "out.exr", "ao.Y"),
                     reflection = channel(dir / "out.exr", "reflection.Y");
  expect_composite(dir, picture, [&](std::size_t i) {
    return kLamp + ao[i] * kAmbient - (1 - reflection[i]) * specular;
  });
  EXPECT_LT(*std::min_element(reflection.pixels.begin(), reflection.pixels.end()), 0.5f);
  const Plane<glm::vec3> before = colors(dir);
  compose(dir, kAmbientLayer + std::vector<std::string>{"--aov", "specular=ViewLayer.Env",
                                                        "--products", "composite"});
  EXPECT_EQ(colors(dir).pixels, before.pixels) << "roughness is looked for without the product";
  const Finished idle =
      run_tool(flags + std::vector<std::string>{dir / "in.exr", "-o", dir / "other.exr",
                                                "--compose", "relight"});
  EXPECT_EQ(idle.code, 0);
  EXPECT_THAT(idle.err,
              HasSubstr("--aov ambient has no effect: composite relight does not use it"));
  EXPECT_THAT(idle.err,
              HasSubstr("--aov specular has no effect: composite relight does not use it"));
}

TEST(Compose, AddPutsLightOnABeautyThatHasNone) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  write_frame(dir / "in.exr", rendered(picture, 0.5f));
  compose(dir,
          {"--compose", "add", "--env", "0.5,1,2", "--aov", "albedo:straight=ViewLayer.DiffCol"});
  const Plane<glm::vec3> direct = colors(dir, "direct."), bounce = colors(dir, "bounce.");
  const auto expected = [&](std::size_t i) {
    return 0.5f * (kLamp + kAmbient + 0.5f * (direct[i] + bounce[i]));
  };
  expect_composite(dir, picture, expected, 1e-5f, 0.5f);
}

TEST(Compose, ALayerOfAmbientLightChoosesOccludeAndTheFlagAnyOther) {
  const TempDir dir;
  write_frame(dir / "in.exr", rendered(ball_on_table()));
  const auto plan = [&](const std::vector<std::string>& flags) {
    const Finished done = run_tool(
        std::vector<std::string>{"info", dir / "in.exr", "--json", "--products", "composite"} +
        flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out)["plan"];
  };
  EXPECT_EQ(plan({})["compose"], "relight") << "a layer becomes ambient on request only";
  EXPECT_EQ(plan({})["bounces"], 1);
  const json occlude = plan(kAmbientLayer);
  EXPECT_EQ(occlude["compose"], "occlude");
  EXPECT_EQ(occlude["bounces"], 0);
  EXPECT_THAT(occlude["reasons"].dump(), HasSubstr("with its ambient layer times ao; an ambient"));
  EXPECT_EQ(plan({"--compose", "add"})["compose"], "add");
  EXPECT_EQ(plan(kAmbientLayer + std::vector<std::string>{"--compose", "relight"})["compose"],
            "relight");
}

TEST(Compose, SaysWhatALayerIsMissingFor) {
  const TempDir dir;
  FramePart part = rendered(ball_on_table());
  write_frame(dir / "in.exr", part);
  const auto refused = [&](const std::vector<std::string>& flags) {
    const Finished done =
        run_tool(std::vector<std::string>{dir / "in.exr", "-o", dir / "out.exr"} + flags);
    EXPECT_EQ(done.code, 4);
    return done.error_line();
  };
  const std::string file = "ssdo: " + (dir / "in.exr").string();
  EXPECT_EQ(refused({"--compose", "occlude"}),
            file +
                ": --compose occlude needs the ambient layer of the render, which no name tells; "
                "name it with --aov ambient=LAYER, or give --compose add for a beauty without "
                "ambient light");
  EXPECT_THAT(refused({"--aov", "ambient=Fill"}), HasSubstr("'Fill' with channels for ambient"));
  std::erase_if(part.channels,
                [](const auto& item) { return item.first.starts_with("ViewLayer.Combined."); });
  write_frame(dir / "in.exr", part);
  EXPECT_EQ(refused({"--compose", "occlude"}),
            file +
                ": --compose occlude needs the ambient layer of the render, which no name tells; "
                "name it with --aov ambient=LAYER");
  EXPECT_EQ(refused({"--compose", "add"}),
            file +
                ": --compose add needs a layer for beauty and none was found by name; name one "
                "with --aov beauty=LAYER, or give --compose relight");
}

TEST(Compose, BrokenPixelsKeepTheBeautyOrStayOut) {
  const TempDir dir;
  const Picture picture = ball_on_table();
  FramePart part = rendered(picture);
  part.channels["ViewLayer.Sky.G"](32, 24) = NAN;
  part.channels["ViewLayer.Combined.R"](33, 24) = INFINITY;
  part.channels["ViewLayer.Position.X"](34, 24) = NAN;
  part.channels["ViewLayer.Depth.Z"](34, 24) = NAN;
  write_frame(dir / "in.exr", part);
  compose(dir, kAmbientLayer);
  const Plane<glm::vec3> found = colors(dir);
  for (const glm::vec3& color : found.pixels)
    EXPECT_TRUE(std::isfinite(color.x + color.y + color.z));
  ASSERT_TRUE(picture.valid(34, 24));
  EXPECT_EQ(found(34, 24), kLamp + kAmbient) << "no geometry: as rendered";
  EXPECT_EQ(channel(dir / "out.exr", "A")(34, 24), 1);
}

}  // namespace
}  // namespace ssdo::test::ambient_test
