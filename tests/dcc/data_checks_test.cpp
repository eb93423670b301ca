// SPDX-License-Identifier: Apache-2.0
//
// What would be wrong in silence is found in the data, and said: encodings, spaces, kinds of depth
// and backgrounds of one shot.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "dcc/data_checks.h"

namespace ssdo::test::data_checks_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST_F(DataChecks, NormalsOfAnySpaceAndEncodingAreThoseOfP) {
  const std::vector<std::pair<Content, std::string>> spaces = {
      {world_normal(), "the space of P"},
      {world_normal(kMirror), "the space of P, axes (-x, y, z)"},
      {world_normal(-1.0f * glm::mat3(1)), "the space of P, turned round"},
      {world_normal(kTurn), "a space of its own, "},
      {camera_normal(), "camera space"},
      {camera_normal({1, -1, -1}), "camera space, axes (x, -y, -z)"}};
  for (const auto& [normal, name] : spaces) {
    for (const bool encoded : {false, true}) {
      SCOPED_TRACE(name + (encoded ? ", 0..1" : ""));
      const StoredShot shot = with(Role::normal, encoded ? as_color(normal) : normal);
      const json found = info(shot);
      EXPECT_THAT(found["normals"]["space"].get<std::string>(), HasSubstr(name));
      EXPECT_EQ(warnings_of(found).size(), encoded ? 1u : 0u) << found["warnings"];
      EXPECT_LT(off(shot), 2e-3);
    }
  }
}

TEST_F(DataChecks, TheKindOfDepthIsThatOfP) {
  const std::vector<std::pair<Content, std::string>> kinds = {{planar_depth(), "planar"},
                                                              {ray_depth(), "ray"}};
  for (const auto& [depth, kind] : kinds) {
    for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF}) {
      const json found = info(with(Role::depth, depth, type));
      EXPECT_EQ(found["depth"]["kind"], kind);
      EXPECT_EQ(found["depth"]["source"], "by P");
      EXPECT_THAT(warnings_of(found), IsEmpty());
    }
  }
}

TEST_F(DataChecks, TheKindOfADepthAloneIsHeldToTheNormals) {
  for (const Content& normal : {world_normal(kTurn), camera_normal()}) {
    StoredShot shot = with(Role::depth, ray_depth());
    drop(shot, Role::position);
    for (StoredLayer& layer : shot.layers)
      if (layer.role == Role::normal) layer.content = normal;
    EXPECT_THAT(warnings_of(info(shot, {"--fov", "40"})),
                ElementsAre(HasSubstr("by the normals it is the distance along the rays")));
    EXPECT_THAT(warnings_of(info(shot, {"--fov", "40", "--depth-kind", "ray"})), IsEmpty());
    for (StoredLayer& layer : shot.layers)
      if (layer.role == Role::depth) layer.content = planar_depth();
    EXPECT_THAT(warnings_of(info(shot, {"--fov", "40"})), IsEmpty());
  }
}

TEST_F(DataChecks, ADepthOfAnotherMeaningIsLeftOutWithWhatItIs) {
  const std::vector<std::pair<Content, std::string>> wrong = {
      {remapped_depth(), "it changes by 0.125 per unit of P: of another unit, or remapped"},
      {remapped_depth(10, 2), "it changes by 0.125 per unit of P"},
      {planar_depth(0, 100), "it changes by 100 per unit of P"},
      {inverse_depth(), "it is 1 / Z: give --depth-kind inverse"},
      {planar_depth(0, 0), "it is empty"}};
  for (const auto& [depth, text] : wrong) {
    const json found = info(with(Role::depth, depth));
    EXPECT_EQ(found["depth"]["used"], false);
    EXPECT_THAT(warnings_of(found), ElementsAre(HasSubstr("depth contradicts P (" + text)));
    EXPECT_LT(off(with(Role::depth, depth)), 1e-6);
  }
  EXPECT_LT(off(with(Role::depth, inverse_depth()), {"--depth-kind", "inverse"}), 1e-6);
  EXPECT_EQ(said_, "") << "as it is said what it is";
}

TEST_F(DataChecks, BackgroundOfAnyValueIsBackground) {
  for (const float empty : {0.0f, 1e10f, kInfinity, -kInfinity, NAN}) {
    for (const float far : {0.0f, 1e10f, kInfinity, NAN}) {
      StoredShot shot = with(Role::position, world_position(glm::mat3(1), empty));
      for (StoredLayer& layer : shot.layers)
        if (layer.role == Role::depth) layer.content = planar_depth(far);
      EXPECT_EQ(off(shot), 0) << empty << " " << far;
      EXPECT_EQ(said_, "");
    }
    StoredShot alone = with(Role::position, world_position(glm::mat3(1), empty));
    drop(alone, Role::depth);
    EXPECT_EQ(off(alone), 0) << empty;
    EXPECT_EQ(said_, "");
  }
}

TEST_F(DataChecks, BackgroundOfADepthAloneIsBackground) {
  const auto surfaces = [&](float empty, Imf::PixelType type) {
    StoredShot shot = with(Role::depth, planar_depth(empty), type);
    drop(shot, Role::position);
    drop(shot, Role::normal);
    return info(shot, {"--fov", "40"})["surface_pixels"];
  };
  const json expected = info(plain_shot())["surface_pixels"];
  for (const float empty : {0.0f, 1e10f, kInfinity, NAN})
    EXPECT_EQ(surfaces(empty, Imf::FLOAT), expected) << empty;
  EXPECT_EQ(surfaces(65504, Imf::HALF), expected) << "the largest half";
}

TEST_F(DataChecks, PInHalfIsWarnedOf) {
  const StoredShot shot = with(Role::position, world_position(), Imf::HALF);
  EXPECT_LT(off(shot), 0.02);
  EXPECT_THAT(said_, HasSubstr("position is stored in 16 bits"));
  // Far is the largest half, with no depth that says so.
  StoredShot alone = with(Role::position, world_position(glm::mat3(1), 65504), Imf::HALF);
  drop(alone, Role::depth);
  for (StoredLayer& layer : alone.layers)
    if (layer.role == Role::normal)
      layer.content = [](const ShotPixel& p) {
        return glm::vec4(p.surface ? p.normal : glm::vec3(0, 0, 1), 1);
      };
  EXPECT_LT(off(alone), 0.02);
  EXPECT_EQ(info(alone)["surface_pixels"], info(plain_shot())["surface_pixels"]);
}

/// A map no two columns of which are alike, or its mirror image; with or without a sun.
FramePart painted(bool mirrored, bool sun = false) {
  const Window window{0, 0, 64, 32};
  FramePart part{"", window, window, {}, Imf::FLOAT, {}};
  Plane<float> grey(64, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float sky = 0.2f + 0.02f * float(x);
      grey(mirrored ? 63 - x : x, y) = sun && y == 6 && x == 10 ? 500.0f : sky;
    }
  }
  for (const char* component : {"R", "G", "B"}) part.channels[component] = grey;
  return part;
}

/// The plain shot in another world.
StoredShot in_world(const glm::mat3& world) {
  StoredShot shot = plain_shot();
  for (StoredLayer& layer : shot.layers) {
    if (layer.role == Role::position) layer.content = world_position(world);
    if (layer.role == Role::normal) layer.content = world_normal(world);
  }
  return shot;
}

TEST_F(DataChecks, ALeftHandedWorldIsLitAsItsMirrorImage) {
  const StoredShot right = in_world(kYUp), left = in_world(kMirror * kYUp);
  EXPECT_EQ(info(left)["position"]["handedness"], "left");
  EXPECT_EQ(info(right)["position"]["handedness"], "right");
  const std::string map = dir_ / "map.exr", mirrored = dir_ / "mirrored.exr";
  for (const bool sun : {false, true}) {
    write_frame(map, painted(false, sun));
    write_frame(mirrored, painted(true, sun));
    const Plane<float> expected = result(right, "direct.R", {"--env", map});
    const double noise = rmse(result(right, "direct.R", {"--env", map, "--seed", "1"}), expected);
    EXPECT_LT(rmse(result(left, "direct.R", {"--env", mirrored}), expected),
              sun ? 1.2 * noise : 1e-3);
    EXPECT_THAT(said_, HasSubstr("the world of P is left-handed: the map"));
    EXPECT_GT(rmse(result(left, "direct.R", {"--env", map}), expected), 2 * noise);
  }
  Plane<float> bent = result(right, "bent.X");
  for (float& x : bent.pixels) x = -x;
  EXPECT_LT(rmse(result(left, "bent.X"), bent), 1e-4);
}

TEST_F(DataChecks, SpaceByOptionTakesNormalsAsGiven) {
  const StoredShot turned = with(Role::normal, world_normal(kTurn));
  json found = info(turned, {"--space", "world"});
  EXPECT_EQ(found["normals"]["space"], "the space of P, by --space");
  EXPECT_EQ(found["normals"]["rebuilt"], 0);
  EXPECT_THAT(
      warnings_of(found),
      ElementsAre(HasSubstr("--space world: taken as the space of P, normals agree with P")));
  EXPECT_GT(off(turned, {"--space", "world"}), 0.02);
  EXPECT_EQ(off(plain_shot(), {"--space", "world"}), 0);
  EXPECT_EQ(said_, "");

  const StoredShot vray = with(Role::normal, camera_normal());
  found = info(vray, {"--space", "camera"});
  EXPECT_EQ(found["normals"]["space"], "camera space, by --space");
  EXPECT_EQ(found["position"]["space"], "camera");
  EXPECT_THAT(warnings_of(found),
              ElementsAre(HasSubstr("--space camera: the camera of P stands elsewhere")));
}

TEST_F(DataChecks, SpaceByOptionDecidesWhetherThereIsAWorld) {
  write_frame(dir_ / "map.exr", painted(false));
  StoredShot shot = with(Role::position, camera_position());
  for (StoredLayer& layer : shot.layers)
    if (layer.role == Role::normal) layer.content = camera_normal();
  // A learned prior looks for a way up in worlds only.
  std::vector<std::string> lit = {"--env", dir_ / "map.exr", "--prior", "rules"};
  const Plane<float> in_camera = result(shot, "direct.R", lit);
  EXPECT_THAT(said_, HasSubstr("the frame knows no world space"));
  lit.insert(lit.end(), {"--space", "world"});
  const Plane<float> of_world = result(shot, "direct.R", lit);
  EXPECT_EQ(said_, "");
  EXPECT_LT(rmse(in_camera, of_world), 1e-6) << "the camera stands at the origin of its world";
  EXPECT_EQ(info(shot)["position"]["space"], "camera");
  EXPECT_EQ(info(shot, {"--space", "world"})["position"]["space"], "world");
}

TEST_F(DataChecks, SpaceWorldOfADepthNeedsAPose) {
  StoredShot shot = plain_shot();
  drop(shot, Role::position);
  write_shot(input_, shot);
  const Finished done = run_tool({"info", input_, "--fov", "40", "--space", "world"});
  EXPECT_EQ(done.code, 4);
  EXPECT_THAT(done.error_line(), HasSubstr("--space world: without P, the pose"));

  const std::string camera = dir_ / "camera.json";
  const std::string found = info(plain_shot())["camera"].dump();
  std::ofstream(camera) << found;
  EXPECT_LT(off(shot, {"--camera", camera, "--space", "world"}), 1e-3);
  EXPECT_EQ(said_, "");
  EXPECT_EQ(info(shot, {"--camera", camera, "--space", "world"})["normals"]["space"],
            "the world of --camera, by --space");

  drop(shot, Role::normal);
  EXPECT_THAT(warnings_of(info(shot, {"--fov", "40", "--space", "camera"})),
              ElementsAre(HasSubstr("--space has no effect")));
}

}  // namespace
}  // namespace ssdo::test::data_checks_test
