// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::layers_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

json info(const std::string& path, std::vector<std::string> flags = {}) {
  flags.insert(flags.begin(), {"info", path, "--json"});
  const Finished done = run_tool(flags);
  EXPECT_EQ(done.code, 0) << done.err;
  return done.code == 0 ? parse_json(done.out) : json();
}

/// ao of a frame, as floats.
Plane<float> ao_of(const TempDir& dir, const FramePart& part, std::vector<std::string> flags = {}) {
  write_frame(dir / "in.exr", part);
  flags.insert(flags.begin(), {dir / "in.exr", "-o", dir / "out.exr", "--overwrite", "--pixel-type",
                               "float", "--radius", "0.5"});
  const Finished done = run_tool(flags);
  EXPECT_EQ(done.code, 0) << done.err;
  return channel(dir / "out.exr", "ao.Y");
}

double mean_difference(const Plane<float>& a, const Plane<float>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / double(a.size());
}

void erase_layer(FramePart& part, const std::string& layer) {
  std::erase_if(part.channels,
                [&](const auto& item) { return item.first.starts_with(layer + "."); });
}

/// The G-buffers that Blender wrote: ours, and those beside the checkout where there are any.
std::vector<std::pair<std::string, std::string>> real_frames() {
  std::vector<std::pair<std::string, std::string>> frames;
  for (const std::string name : {"still_life", "room_corner"}) {
    frames.emplace_back(data(name + ".exr"), data(name + ".camera.json"));
  }
  const std::filesystem::path shared = std::string(SSDO_SOURCE_DIR) + "/../shared/truth/public";
  if (std::filesystem::exists(shared)) {
    for (const auto& scene : std::filesystem::directory_iterator(shared)) {
      frames.emplace_back(scene.path() / "gbuffer.exr", scene.path() / "camera.json");
    }
  }
  return frames;
}

TEST(Info, FindsLayersAndCameraOfRealFramesWithoutFlags) {
  for (const auto& [frame, camera_file] : real_frames()) {
    SCOPED_TRACE(frame);
    const json found = info(frame);
    const json truth = parse_json(read_file(camera_file));
    EXPECT_EQ(found["layers"]["position"]["layer"], "ViewLayer.Position");
    EXPECT_EQ(found["layers"]["normal"]["layer"], "ViewLayer.Normal");
    EXPECT_EQ(found["layers"]["albedo"]["layer"], "ViewLayer.DiffCol");
    EXPECT_EQ(found["layers"]["depth"]["layer"], "ViewLayer.Depth");
    EXPECT_LE(found["camera"]["residual_px"]["p99"].get<double>(), 0.01);
    EXPECT_NEAR(found["camera"]["fx"].get<double>() / truth["fx"].get<double>(), 1, 1e-5);
    EXPECT_NEAR(found["camera"]["cx"].get<double>(), truth["cx"].get<double>(), 0.01);
    EXPECT_NEAR(found["camera"]["cy"].get<double>(), truth["cy"].get<double>(), 0.01);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        EXPECT_NEAR(found["camera"]["world_to_camera"][row][column].get<double>(),
                    truth["world_to_camera"][row][column].get<double>(), 1e-3);
      }
    }
  }
}

TEST(Info, SaysWhatItFoundAndWouldDo) {
  const Finished done = run_tool({"info", data("still_life.exr")});
  EXPECT_EQ(done.code, 0);
  for (const char* word : {"ViewLayer.Position.X", "fitted from P", "45.000 degrees", "background",
                           "radius inf", "bitmask", "surfaces continue behind them"}) {
    EXPECT_THAT(done.out, HasSubstr(word));
  }
  const json j = info(data("still_life.exr"));
  EXPECT_EQ(j["plan"]["method"], "bitmask");
  EXPECT_EQ(j["plan"]["radius"], "inf");
  const json old = info(data("still_life.exr"), {"--method", "ssdo"});
  EXPECT_GT(old["plan"]["radius"].get<double>(), 0.1);
  const Finished sky =
      run_tool({"info", data("still_life.exr"), "--env", data("environments/sky.exr")});
  EXPECT_THAT(sky.out,
              testing::AllOf(HasSubstr("a sun"), HasSubstr("spherical harmonics to order")));
  // Its key light is 64 x 44 degrees between soft edges, its rim light 14 x 70.
  const Finished studio =
      run_tool({"info", data("still_life.exr"), "--env", data("environments/studio.exr")});
  EXPECT_THAT(studio.out, testing::AllOf(HasSubstr("a source 64 x 43 degrees"),
                                         HasSubstr("a source 68 x 15 degrees"),
                                         HasSubstr("harmonics would hold")));
  EXPECT_EQ(j["surface_pixels"].get<int>() + j["background_pixels"].get<int>(), 576 * 324);
}

TEST(Layers, ARequestNamesALayerHereOrInAnotherFile) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  const Plane<float> expected = ao_of(dir, part);
  FramePart positions = part;
  erase_layer(part, "ViewLayer.Position");
  erase_layer(positions, "ViewLayer.Depth");
  for (const char* c : {"X", "Y", "Z"})
    part.channels[std::string("odd.") + c] =
        positions.channels[std::string("ViewLayer.Position.") + c];
  erase_layer(part, "ViewLayer.Depth");
  EXPECT_EQ(ao_of(dir, part, {"--aov", "position=odd"}).pixels, expected.pixels);

  erase_layer(part, "odd");
  part.channels["Z"] = Plane<float>(64, 48, 5);  // so that there is something to find
  write_frame(dir / "p.exr", positions);
  const std::string other = std::string(dir / "p.exr") + ":ViewLayer.Position";
  EXPECT_LT(mean_difference(ao_of(dir, part, {"--aov", "position=" + other}), expected), 1e-6);
}

TEST(Layers, DepthAloneNeedsAFieldOfViewAndThenServes) {
  const TempDir dir;
  const Picture picture = small_picture();
  FramePart part = frame_of(picture);
  const Plane<float> expected = ao_of(dir, part);
  erase_layer(part, "ViewLayer.Position");
  // N stands in the world, which depth alone does not know: it is rebuilt.
  erase_layer(part, "ViewLayer.Normal");
  write_frame(dir / "in.exr", part);
  const Finished refused = run_tool({dir / "in.exr", "-o", dir / "no.exr"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.error_line(), HasSubstr("--fov DEGREES"));
  EXPECT_LT(mean_difference(ao_of(dir, part, {"--fov", "40"}), expected), 0.01);

  FramePart ray = part;
  Plane<float>& z = ray.channels["ViewLayer.Depth.Z"];
  for (std::size_t i = 0; i < z.size(); ++i) {
    const glm::dvec3 p = picture.camera.to_camera(glm::dvec3(picture.position[i]));
    if (picture.valid[i]) z[i] = float(glm::length(p));
  }
  const Plane<float> planar = ao_of(dir, part, {"--fov", "40"});
  EXPECT_LT(mean_difference(ao_of(dir, ray, {"--fov", "40", "--depth-kind", "ray"}), planar), 1e-3);
  FramePart inverse = part;
  for (float& d : inverse.channels["ViewLayer.Depth.Z"].pixels) d = d > 1e9f ? 0 : 1 / d;
  EXPECT_LT(
      mean_difference(ao_of(dir, inverse, {"--fov", "40", "--depth-kind", "inverse"}), planar),
      1e-3);
  FramePart normalized = part;
  for (float& d : normalized.channels["ViewLayer.Depth.Z"].pixels)
    d = d > 1e9f ? 1e10f : (d - 2) / 18;
  write_frame(dir / "in.exr", normalized);
  EXPECT_THAT(run_tool({dir / "in.exr", "-o", dir / "no.exr", "--fov", "40"}).error_line(),
              HasSubstr("--depth-kind normalized:NEAR,FAR"));
  EXPECT_LT(mean_difference(
                ao_of(dir, normalized, {"--fov", "40", "--depth-kind", "normalized:2,20"}), planar),
            1e-3);
}

TEST(Layers, NormalsAreTakenInAnySpaceAndEncoding) {
  const TempDir dir;
  const Picture picture = small_picture();
  const FramePart world = frame_of(picture);
  const Plane<float> expected = ao_of(dir, world);

  FramePart encoded = world;
  for (const char* c : {"X", "Y", "Z"}) {
    for (float& v : encoded.channels[std::string("ViewLayer.Normal.") + c].pixels)
      v = 0.5f * v + 0.5f;
  }
  EXPECT_LT(mean_difference(ao_of(dir, encoded), expected), 1e-4);
  EXPECT_THAT(info(dir / "in.exr")["warnings"].dump(), HasSubstr("0..1"));

  Picture camera_normals = picture;
  for (glm::vec3& n : camera_normals.normal.pixels)
    n = glm::vec3(picture.camera.rotation * glm::dvec3(n));
  FramePart camera = world;
  camera.add("ViewLayer.Normal", camera_normals.normal);
  EXPECT_LT(mean_difference(ao_of(dir, camera), expected), 1e-4);
  EXPECT_EQ(info(dir / "in.exr")["normals"]["space"], "camera space");

  FramePart none = world;
  erase_layer(none, "ViewLayer.Normal");
  EXPECT_LT(mean_difference(ao_of(dir, none), expected), 0.02);
  EXPECT_EQ(info(dir / "in.exr")["normals"]["space"], "rebuilt from P");

  Picture turned = picture;
  for (std::size_t i = 0; i < turned.normal.size(); i += 2) turned.normal[i] = -turned.normal[i];
  FramePart backs = world;
  backs.add("ViewLayer.Normal", turned.normal);
  EXPECT_LT(mean_difference(ao_of(dir, backs), expected), 0.01)
      << "the backs are turned to the viewer";

  FramePart scaled = world;
  for (const char* c : {"X", "Y", "Z"}) {
    for (float& v : scaled.channels[std::string("ViewLayer.Normal.") + c].pixels) v *= 0.7f;
  }
  EXPECT_LT(mean_difference(ao_of(dir, scaled), expected), 1e-4)
      << "averaged normals are made unit";
}

TEST(Layers, PositionsInCameraSpaceGiveTheSameOcclusion) {
  const TempDir dir;
  const Picture picture = small_picture();
  const Plane<float> expected = ao_of(dir, frame_of(picture));
  Picture local = picture;
  for (std::size_t i = 0; i < local.position.size(); ++i) {
    local.position[i] = glm::vec3(picture.camera.to_camera(glm::dvec3(picture.position[i])));
    local.normal[i] = glm::vec3(picture.camera.rotation * glm::dvec3(picture.normal[i]));
  }
  FramePart part = frame_of(picture);
  part.add("ViewLayer.Position", local.position);
  part.add("ViewLayer.Normal", local.normal);
  EXPECT_LT(mean_difference(ao_of(dir, part), expected), 1e-3);
  const json with_sky = info(dir / "in.exr", {"--env", data("environments/sky.exr")});
  EXPECT_THAT(with_sky["warnings"].dump(), HasSubstr("camera space"));
}

TEST(Layers, HalfPositionsAreWarnedOfAndStillServe) {
  const TempDir dir;
  FramePart part = frame_of(small_picture());
  const Plane<float> expected = ao_of(dir, part);
  part.type = Imf::HALF;
  for (float& z : part.channels["ViewLayer.Depth.Z"].pixels) z = z > 1e9f ? INFINITY : z;
  EXPECT_LT(mean_difference(ao_of(dir, part), expected), 0.01);
  EXPECT_THAT(info(dir / "in.exr")["warnings"].dump(), HasSubstr("16 bits"));
}

TEST(Layers, AFlatFrameAsksForTheFieldOfView) {
  const TempDir dir;
  const Window window{0, 0, 64, 48};
  const Camera camera = look_at(camera_from_fov(40, window, 1), {0, -4, 3}, {0, 0, 0}, {0, 0, 1});
  write_frame(dir / "flat.exr", frame_of(take_picture(plane({}, {0, 0, 1}), camera, window)));
  const Finished refused = run_tool({"info", dir / "flat.exr"});
  EXPECT_EQ(refused.code, 4);
  EXPECT_THAT(refused.error_line(), HasSubstr("--fov"));
  const json found = info(dir / "flat.exr", {"--fov", "40"});
  EXPECT_LT(found["camera"]["residual_px"]["p99"].get<double>(), 0.05);
  EXPECT_EQ(run_tool({"info", dir / "flat.exr", "--fov", "20"}).code, 4) << "P contradicts it";
}

}  // namespace
}  // namespace ssdo::test::layers_test
